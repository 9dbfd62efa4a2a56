// The ros2_control plugin among the doubles: against records of the Rust supervisor, bit for bit, and against what
// people get wrong. Arguments: the folder that `ros2_record` wrote. Compiled twice, as Humble and as Jazzy.
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <fstream>
#include <iostream>
#include <limits>
#include <memory>
#include <new>
#include <sstream>
#include <string>
#include <vector>

#include "ros_doubles.hpp"

std::shared_ptr<controller_interface::ChainableControllerInterface> make_plugin();

// Every way to the heap is counted: that of C++, and with it that of Rust, which asks C's.
#ifdef __GLIBC__
namespace
{
thread_local unsigned long allocations = 0;
}
extern "C" {
void * __libc_malloc(std::size_t);
void * __libc_calloc(std::size_t, std::size_t);
void * __libc_realloc(void *, std::size_t);
void * __libc_memalign(std::size_t, std::size_t);
void * malloc(std::size_t size) {++allocations; return __libc_malloc(size);}
void * calloc(std::size_t count, std::size_t size) {++allocations; return __libc_calloc(count, size);}
void * realloc(void * at, std::size_t size) {++allocations; return __libc_realloc(at, size);}
void * aligned_alloc(std::size_t align, std::size_t size) {++allocations; return __libc_memalign(align, size);}
int posix_memalign(void ** at, std::size_t align, std::size_t size)
{
  ++allocations;
  *at = __libc_memalign(align, size);
  return *at == nullptr ? 12 : 0;
}
}
#else
#error "this test counts allocations with glibc"
#endif

namespace
{

using controller_interface::CallbackReturn;
using controller_interface::return_type;
using Numbers = std::vector<double>;
using Names = std::vector<std::string>;

constexpr double NOTHING = std::numeric_limits<double>::quiet_NaN();

int failures = 0;

#define CHECK(condition) check(condition, #condition, __LINE__)

void check(bool condition, const char * text, int line)
{
  if (!condition) {
    std::printf("line %d: %s\n", line, text);
    ++failures;
  }
}

bool has(const std::string & text, const std::string & part) {return text.find(part) != std::string::npos;}

/// A robot's interfaces and the plugin on them, as a controller manager has them.
struct Robot
{
  std::shared_ptr<controller_interface::ChainableControllerInterface> plugin = make_plugin();
  Names joints;
  Numbers position, velocity, effort;
  double brake = 7.0;
  std::vector<hardware_interface::StateInterface> states;
  std::vector<hardware_interface::CommandInterface> commands;
  std::vector<hardware_interface::CommandInterface> references;

  explicit Robot(const Names & names) : joints(names)
  {
    const std::size_t n = names.size();
    position.assign(n, 0.0);
    velocity.assign(n, 0.0);
    effort.assign(n, 7.0);
    plugin->on_init();
    for (std::size_t i = 0; i < n; ++i) {
      states.emplace_back(names[i], "position", &position[i]);
      states.emplace_back(names[i], "velocity", &velocity[i]);
      commands.emplace_back(names[i], "effort", &effort[i]);
    }
    commands.emplace_back("brake", "engaged", &brake);
    set("joints", names);
  }

  template<class T>
  void set(const std::string & key, const T & value)
  {
    plugin->get_node()->parameters[key] = rclcpp::Parameter(value);
  }

  /// What every test here needs.
  void limits()
  {
    const auto same = [this](double value) {return Numbers(joints.size(), value);};
    set("uncertified", true);
    set("limits.torque_max_nm", joints.size() == 2 ? Numbers{60.0, 20.0} : same(60.0));
    set("limits.torque_rate_max_nm_s", same(4000.0));
    set("limits.velocity_max_rad_s", same(8.0));
    set("limits.position_min_rad", same(-2.5));
    set("limits.position_max_rad", same(2.5));
    set("limits.error_stop_rad", same(0.3));
    set("reference.velocity_max_rad_s", same(1.5));
    set("reference.acceleration_max_rad_s2", same(8.0));
    set("reference.jerk_max_rad_s3", same(200.0));
  }

  CallbackReturn configure()
  {
    rclcpp::logged().clear();
    return plugin->on_configure({});
  }

  CallbackReturn activate()
  {
    rclcpp::logged().clear();
    std::vector<hardware_interface::LoanedCommandInterface> out;
    std::vector<hardware_interface::LoanedStateInterface> in;
    for (const std::string & name : plugin->command_interface_configuration().names) {
      for (auto & own : commands) {
        if (own.get_name() == name) {
          out.emplace_back(own);
        }
      }
    }
    for (const std::string & name : plugin->state_interface_configuration().names) {
      for (auto & own : states) {
        if (own.get_name() == name) {
          in.emplace_back(own);
        }
      }
    }
    plugin->assign_interfaces(std::move(out), std::move(in));
    references = plugin->export_reference_interfaces();
    return plugin->on_activate({});
  }

  return_type update(int64_t period_ns)
  {
    return plugin->update(rclcpp::Time(0), rclcpp::Duration(period_ns));
  }

  /// One interface of the arm gives no value: an empty one of Jazzy, a NaN of Humble.
  void lose(std::size_t which)
  {
#ifdef PHIHAT_DOUBLE_JAZZY
    states[which].blocked = true;
#else
    states[which].value() = NOTHING;
#endif
  }

  void found()
  {
    for (auto & state : states) {
      state.blocked = false;
    }
  }

  /// What the node says in its ten times a second.
  diagnostic_msgs::msg::DiagnosticStatus diagnosis()
  {
    using Publisher = rclcpp::Publisher<diagnostic_msgs::msg::DiagnosticArray>;
    auto & node = *plugin->get_node();
    node.timers.back()->callback();
    const auto publisher = std::static_pointer_cast<Publisher>(node.topics.at("/diagnostics"));
    return publisher->published.empty() ? diagnostic_msgs::msg::DiagnosticStatus() : publisher->published.back().status[0];
  }
};

std::string value(const diagnostic_msgs::msg::DiagnosticStatus & status, const std::string & key)
{
  for (const auto & entry : status.values) {
    if (entry.key == key) {
      return entry.value;
    }
  }
  return "no such key";
}

double number(std::istream & from)
{
  std::string hex;
  from >> hex;
  const uint64_t bits = std::strtoull(hex.c_str(), nullptr, 16);
  double made;
  std::memcpy(&made, &bits, sizeof made);
  return made;
}

/// The plugin gives what the Rust supervisor gave, to the bit, and allocates nothing on the way.
void record(const std::string & folder, const std::string & name)
{
  Robot robot({"shoulder", "elbow"});
  robot.limits();
  robot.set("gains_file", folder + "/" + name + ".json");
  if (robot.configure() != CallbackReturn::SUCCESS) {
    std::printf("%s: %s\n", name.c_str(), rclcpp::logged().empty() ? "?" : rclcpp::logged().back().c_str());
    ++failures;
    return;
  }
  robot.plugin->chained = true;
  CHECK(robot.activate() == CallbackReturn::SUCCESS);
  CHECK(robot.references.size() == 6 && robot.references[4].get_name() == "phihat/elbow/velocity");

  std::ifstream file(folder + "/" + name + ".txt");
  std::string line;
  unsigned long rows = 0, differ = 0, came = 0, tracked = 0, stopped = 0, allocated = 0;
  while (std::getline(file, line)) {
    std::istringstream row(line);
    int64_t period = 0;
    int comes = 0, wanted = 0;
    row >> period >> comes >> wanted;
    for (std::size_t i = 0; i < 2; ++i) {
      robot.position[i] = number(row);
      robot.velocity[i] = number(row);
    }
    for (auto & reference : robot.references) {
      const double asked = number(row);
      reference.value() = wanted != 0 ? asked : NOTHING;
    }
    if (comes == 0) {
      robot.lose(rows % 4);
    }
    const unsigned long before = allocations;
    const return_type answer = robot.update(period);
    allocated += allocations - before;
    CHECK(answer == return_type::OK);
    robot.found();
    for (std::size_t i = 0; i < 2; ++i) {
      const double tau = number(row);
      number(row);
      if (std::memcmp(&tau, &robot.effort[i], sizeof tau) != 0 && differ++ == 0) {
        std::printf("%s, row %lu, joint %zu: %.17g, expected %.17g\n", name.c_str(), rows, i, robot.effort[i], tau);
      }
    }
    std::string mode, fault;
    row >> mode >> fault;
    // The node is asked now and then, and where it matters: at the end.
    if (rows % 50 == 0) {
      const auto told = robot.diagnosis();
      CHECK(value(told, "mode") == mode);
      CHECK(value(told, "fault") == (fault == "none" ? "" : fault));
    }
    came += comes != 0;
    tracked += mode == "tracking";
    stopped += mode == "safe-stop";
    ++rows;
  }
  CHECK(rows == 7000 && differ == 0 && allocated == 0);
  CHECK(came < rows - 100 && tracked > 5000 && stopped > 400);
  const auto end = robot.diagnosis();
  CHECK(end.level == diagnostic_msgs::msg::DiagnosticStatus::ERROR);
  CHECK(end.message == "safe-stop: link-lost");
  CHECK(value(end, "samples missed since activation") == std::to_string(rows - came));
  CHECK(has(value(end, "events since activation"), "missed"));
  CHECK(robot.plugin->on_deactivate({}) == CallbackReturn::SUCCESS);
  CHECK(robot.effort[0] <= 0.0 && robot.effort[0] >= 0.0);
  CHECK(robot.update(1000000) == return_type::ERROR);
  // What was latched is gone with the next activation, which starts like the first: with an arm at rest in its range.
  robot.position = robot.velocity = {0.0, 0.0};
  CHECK(robot.activate() == CallbackReturn::SUCCESS);
  CHECK(robot.update(1000000) == return_type::OK);
  CHECK(value(robot.diagnosis(), "mode") == "armed");
  CHECK(robot.plugin->on_cleanup({}) == CallbackReturn::SUCCESS);
  std::printf("%s: %lu rows, %lu samples, %lu tracked, %lu stopped, %lu allocations\n",
    name.c_str(), rows, came, tracked, stopped, allocated);
}

/// Not chained: the arm holds, moves to the targets of ~/reference within the limits, and stays there.
void targets(const std::string & folder)
{
  Robot robot({"shoulder", "elbow"});
  robot.limits();
  robot.set("gains_file", folder + "/observer.json");
  CHECK(robot.configure() == CallbackReturn::SUCCESS);
  auto & node = *robot.plugin->get_node();
  using Subscription = rclcpp::Subscription<sensor_msgs::msg::JointState>;
  const auto topic = std::static_pointer_cast<Subscription>(node.topics.at("~/reference"));
  auto send = [&](const Names & names, const Numbers & positions) {
      auto message = std::make_shared<sensor_msgs::msg::JointState>();
      message->name = names;
      message->position = positions;
      rclcpp::logged().clear();
      topic->callback(message);
    };
  robot.position = {0.2, -0.1};
  // Before the start: not meant for what comes.
  send({"shoulder", "elbow"}, {1.0, 1.0});
  CHECK(robot.activate() == CallbackReturn::SUCCESS);
  const Numbers inertia = {0.35, 0.12};
  unsigned long allocated = 0;
  double fastest = 0.0;
  auto run = [&](int samples) {
      for (int k = 0; k < samples; ++k) {
        const unsigned long before = allocations;
        CHECK(robot.update(1000000) == return_type::OK);
        allocated += allocations - before;
        for (std::size_t i = 0; i < 2; ++i) {
          const double push = 3.0 * std::cos(robot.position[i]);
          robot.velocity[i] += 1e-3 * (robot.effort[i] - push) / inertia[i];
          robot.position[i] += 1e-3 * robot.velocity[i];
          fastest = std::fmax(fastest, std::fabs(robot.velocity[i]));
        }
      }
    };
  run(1000);
  CHECK(value(robot.diagnosis(), "mode") == "holding");
  CHECK(std::fabs(robot.position[0] - 0.2) < 0.02 && std::fabs(robot.position[1] + 0.1) < 0.02);

  // Nonsense changes nothing, and says so.
  send({"shoulder"}, {0.3});
  CHECK(has(rclcpp::logged().at(0), "2 of each are expected"));
  send({"shoulder", "wrist"}, {0.3, 0.3});
  CHECK(has(rclcpp::logged().at(0), "no position for joint elbow"));
  send({"shoulder", "elbow"}, {0.3, NOTHING});
  CHECK(has(rclcpp::logged().at(0), "no position for joint elbow"));
  run(100);
  CHECK(value(robot.diagnosis(), "mode") == "holding");

  // Farther than tracking may start from: the shaper makes the way. In the order of the message, not of the arm.
  fastest = 0.0;
  send({"elbow", "shoulder"}, {-0.9, 1.1});
  run(3000);
  CHECK(value(robot.diagnosis(), "mode") == "tracking");
  CHECK(std::fabs(robot.position[0] - 1.1) < 1e-3 && std::fabs(robot.position[1] + 0.9) < 1e-3);
  CHECK(fastest > 0.5 && fastest < 1.6);
  CHECK(allocated == 0);
#ifdef PHIHAT_DOUBLE_JAZZY
  // A torque that does not go out is told, and is not taken for one that acted.
  robot.commands[1].blocked = true;
  run(3);
  robot.commands[1].blocked = false;
  run(500);
  const auto told = robot.diagnosis();
  CHECK(value(told, "commands not written since activation") == "3");
  CHECK(value(told, "mode") == "tracking");
#endif
}

/// The hardware's brakes: closed before the arm is held, open while it is, asked for in the very cycle in which the supervisor asks, closed where nobody looks
/// after the arm; and an interface that nobody named is left alone.
void brakes(const std::string & folder)
{
  const auto prepared = [&](bool named) {
      auto robot = std::make_unique<Robot>(Names{"shoulder", "elbow"});
      robot->limits();
      robot->set("gains_file", folder + "/observer.json");
      if (named) {
        robot->set("brake_interface", std::string("brake/engaged"));
        robot->set("brake_closing_s", 0.05);
      }
      CHECK(robot->configure() == CallbackReturn::SUCCESS);
      CHECK(robot->activate() == CallbackReturn::SUCCESS);
      return robot;
    };
  const auto is = [](double value, double expected) {return value >= expected && value <= expected;};
  auto robot = prepared(true);
  CHECK(robot->plugin->command_interface_configuration().names == (Names{"shoulder/effort", "elbow/effort", "brake/engaged"}));
  // No sample has come: no torque, and the brakes hold the arm.
  robot->lose(0);
  CHECK(robot->update(1000000) == return_type::OK && is(robot->brake, 1.0) && is(robot->effort[0], 0.0));
  robot->found();
  robot->position = {0.0, 0.0};
  unsigned long allocated = 0;
  const auto run = [&](int samples) {
      for (int k = 0; k < samples; ++k) {
        const unsigned long before = allocations;
        CHECK(robot->update(1000000) == return_type::OK);
        allocated += allocations - before;
        // What the hardware is told is what the supervisor says of the same cycle.
        const bool wanted = value(robot->diagnosis(), "brakes wanted") == "yes";
        CHECK(is(robot->brake, wanted ? 1.0 : 0.0));
      }
    };
  run(100);
  CHECK(value(robot->diagnosis(), "mode") == "holding" && is(robot->brake, 0.0));
  // A joint that is faster than its limit, and gets no better: a safe stop, and the brakes within the second that a stop may take.
  robot->velocity = {9.0, 0.0};
  int taken = 0;
  for (; taken < 1100 && !is(robot->brake, 1.0); ++taken) {
    run(1);
  }
  CHECK(value(robot->diagnosis(), "mode") == "safe-stop" && is(robot->brake, 1.0));
  CHECK(value(robot->diagnosis(), "brakes told by") == "brake/engaged");
  std::printf("brakes: asked for %d samples after the fault\n", taken);
  // They stay closed, and the law gives way to them.
  robot->velocity = {0.0, 0.0};
  run(200);
  CHECK(is(robot->brake, 1.0) && is(robot->effort[0], 0.0) && is(robot->effort[1], 0.0));
  CHECK(allocated == 0);
  CHECK(robot->activate() == CallbackReturn::SUCCESS);
  run(20);
  CHECK(value(robot->diagnosis(), "mode") == "holding" && is(robot->brake, 0.0));
#ifdef PHIHAT_DOUBLE_JAZZY
  // A command that does not go out is told, and is tried again.
  robot->commands[2].blocked = true;
  CHECK(robot->plugin->on_deactivate({}) == CallbackReturn::SUCCESS);
  CHECK(is(robot->brake, 0.0) && has(rclcpp::logged().back(), "brake/engaged could not be set to 1"));
  robot->commands[2].blocked = false;
  CHECK(robot->activate() == CallbackReturn::SUCCESS);
  run(20);
#endif
  CHECK(robot->plugin->on_deactivate({}) == CallbackReturn::SUCCESS);
  CHECK(is(robot->brake, 1.0) && is(robot->effort[0], 0.0));

  // Not named: not claimed, not written.
  robot = prepared(false);
  CHECK(robot->plugin->command_interface_configuration().names.size() == 2);
  CHECK(robot->update(1000000) == return_type::OK && is(robot->brake, 7.0));
  CHECK(value(robot->diagnosis(), "brakes told by") == "none");
  CHECK(robot->plugin->on_deactivate({}) == CallbackReturn::SUCCESS && is(robot->brake, 7.0));

  // A manager that hands over another interface in its place.
  robot = prepared(true);
  std::vector<hardware_interface::LoanedCommandInterface> out;
  std::vector<hardware_interface::LoanedStateInterface> in;
  for (std::size_t i : {0, 1, 1}) {
    out.emplace_back(robot->commands[i]);
  }
  for (auto & state : robot->states) {
    in.emplace_back(state);
  }
  robot->plugin->assign_interfaces(std::move(out), std::move(in));
  CHECK(robot->plugin->on_activate({}) == CallbackReturn::FAILURE);
  CHECK(has(rclcpp::logged().back(), "the interfaces are not shoulder/effort, elbow/effort, brake/engaged"));
}

/// Everything that on_configure refuses, and that it says why.
void refused(const std::string & folder)
{
  const std::string file = folder + "/observer.json";
  const auto why = [&](const Names & joints, auto change) {
      Robot robot(joints);
      robot.limits();
      robot.set("gains_file", file);
      change(robot);
      CHECK(robot.configure() == CallbackReturn::FAILURE);
      return rclcpp::logged().empty() ? std::string("nothing was said") : rclcpp::logged().back();
    };
  const Names own = {"shoulder", "elbow"};
  const auto written = [&](const std::string & text) {
      const std::string path = folder + "/written.json";
      std::ofstream(path) << text;
      return path;
    };
  const auto contents = [](const std::string & path) {
      std::stringstream whole;
      whole << std::ifstream(path).rdbuf();
      return whole.str();
    };
  const auto replaced = [&](std::string in, const std::string & from, const std::string & to) {
      const std::size_t at = in.find(from);
      CHECK(at != std::string::npos);
      return written(in.replace(at, from.size(), to));
    };
  const std::string text = contents(file), seeing = contents(folder + "/positions.json");
  const auto instead = [&](const std::string & from, const std::string & to) {return replaced(text, from, to);};
  const auto filtered = [&](const std::string & to) {return replaced(seeing, "[{\"rates\": [0.001, 0.13]", to);};
  const auto braked = [](const std::string & name, double closing) {
      return [=](Robot & r) {r.set("brake_interface", name); r.set("brake_closing_s", closing);};
    };
  struct Case
  {
    std::string said, expected;
  };
  const Case cases[] = {
    {why({"elbow", "shoulder"}, [](Robot &) {}),
      "the gains are for joints shoulder, elbow; parameter joints is elbow, shoulder"},
    {why({"shoulder"}, [](Robot &) {}), "the gains are for joints shoulder, elbow; parameter joints is shoulder"},
    {why(own, [](Robot & r) {r.set("gains_file", std::string());}), "gains_file is not set"},
    {why(own, [](Robot & r) {r.set("gains_file", std::string("/none"));}), "/none: cannot be read"},
    {why(own, [](Robot & r) {r.set("uncertified", false);}), "carry no certificate"},
    {why(own, [](Robot & r) {r.plugin->update_rate = 500;}), "1000.000000 Hz; this controller runs at 500"},
    {why(own, [](Robot & r) {r.set("limits.torque_max_nm", Numbers());}), "joint shoulder: no torque limit"},
    {why(own, [](Robot & r) {r.set("limits.torque_max_nm", Numbers{60.0});}), "has 1 entries; 2 are expected"},
    {why(own, [](Robot & r) {r.set("limits.torque_max_nm", Numbers{60.0, -1.0});}), "(elbow)"},
    {why(own, [](Robot & r) {r.set("limits.position_max_rad", Numbers());}), "one is infinite, the other not"},
    {why(own, [](Robot & r) {r.set("reference.jerk_max_rad_s3", Numbers());}), "every reference is shaped"},
    {why(own, [](Robot & r) {r.set("preset_nm", Numbers{0.0, NOTHING});}), "joint elbow: preset_nm"},
    {why(own, [](Robot & r) {r.set("torque_delay_samples", int64_t{65});}), "torque_delay_samples is 65"},
    {why(own, [](Robot & r) {r.set("brake_closing_s", 0.1);}), "brake_interface names no command interface"},
    {why(own, braked("brake/engaged", 0.0)), "brake_closing_s is 0.000000; with brake_interface brake/engaged, more than 0 s"},
    {why(own, braked("brake/engaged", NOTHING)), "brake_closing_s is nan"},
    {why(own, braked("brake/engaged", 11.0)), "at most 10 s"},
    {why(own, braked("brake", 0.1)), "brake_interface is brake; the name of a command interface"},
    {why(own, braked("brake/", 0.1)), "brake_interface is brake/; the name of a command interface"},
    {why(own, [&](Robot & r) {r.set("gains_file", written("gains: 1"));}), "line 1, column 1"},
    {why(own, [&](Robot & r) {r.set("gains_file", written("{\"format\": \"urdf\"}"));}), "not gains"},
    {why(own, [&](Robot & r) {r.set("gains_file", written(text.substr(0, text.size() / 2)));}), "line "},
    {why(own, [&](Robot & r) {r.set("gains_file", written(std::string(100, '[')));}), "nested deeper"},
    {why(own, [&](Robot & r) {r.set("gains_file", instead("\"version\": 3", "\"version\": 4"));}), "version is 4"},
    {why(own, [&](Robot & r) {r.set("gains_file", instead("400.0", "\"400\""));}), "no number"},
    {why(own, [&](Robot & r) {r.set("gains_file", instead("400.0", "1e999"));}), "not a number of a double's range"},
    {why(own, [&](Robot & r) {r.set("gains_file", instead("400.0", "-400.0"));}), "gains or limits are refused"},
    {why(own, [&](Robot & r) {r.set("gains_file", instead("\"elbow\"", "\"shoulder\""));}), "there twice"},
    {why(own, [&](Robot & r) {r.set("gains_file", filtered("[{\"rates\": [0.001]"));}), "section 0: rates: two numbers"},
    {why(own, [&](Robot & r) {r.set("gains_file", filtered("[{\"rate\": [0.001, 0.13]"));}), "section 0: rates: a list"},
    {why(own, [&](Robot & r) {r.set("gains_file", filtered("[{\"rates\": [0.13, 0.001]"));}), "section 0 of the innovation filter"},
    {why(own, [&](Robot & r) {r.set("gains_file", filtered("[{}, {\"rates\": [0.001, 0.13]"));}), "up to 2 sections"},
  };
  for (const Case & one : cases) {
    if (!has(one.said, one.expected)) {
      std::printf("said: %s\nexpected: %s\n", one.said.c_str(), one.expected.c_str());
      ++failures;
    }
  }
  std::printf("refused: %zu mistakes\n", std::size(cases));

  // The interfaces that a manager hands over have to be those that were claimed, in that order.
  Robot robot(own);
  robot.limits();
  robot.set("gains_file", file);
  CHECK(robot.configure() == CallbackReturn::SUCCESS);
  std::swap(robot.joints[0], robot.joints[1]);
  CHECK(robot.activate() == CallbackReturn::SUCCESS);
  std::vector<hardware_interface::LoanedCommandInterface> out;
  std::vector<hardware_interface::LoanedStateInterface> in;
  for (std::size_t i : {0, 1}) {
    out.emplace_back(robot.commands[i]);
  }
  for (std::size_t i : {2, 3, 0, 1}) {
    in.emplace_back(robot.states[i]);
  }
  robot.plugin->assign_interfaces(std::move(out), std::move(in));
  CHECK(robot.plugin->on_activate({}) == CallbackReturn::FAILURE);
  CHECK(has(rclcpp::logged().back(), "the interfaces are not shoulder/position"));
}

/// A certificate names limits and loop; nothing has to be typed but how the reference is shaped. It is written here by
/// hand, with the members that the plugin reads.
void certified(const std::string & folder)
{
  Robot robot({"shoulder", "elbow"});
  robot.limits();
  robot.set("uncertified", false);
  robot.set("limits.torque_max_nm", Numbers());
  robot.set("limits.torque_rate_max_nm_s", Numbers());
  robot.set("gains_file", folder + "/written.json");
  std::stringstream whole;
  whole << std::ifstream(folder + "/observer.json").rdbuf();
  const auto configured = [&](const std::string & velocity, const std::string & filter, const std::string & refused) {
      const auto joint = [&](const std::string & name) {
          return "{\"name\": \"" + name + "\", \"limits\": [60.0, null], \"refused\": [" + refused + "], \"model\": "
                 "{\"delay_samples\": 1, \"velocity\": \"" + velocity + "\", \"velocity_filter_hz\": " + filter +
                 ", \"form\": \"observer\"}}";
        };
      std::string text = whole.str();
      const std::size_t at = text.find("\"joints\"");
      CHECK(at != std::string::npos);
      text.insert(
        at == std::string::npos ? 0 : at,
        "\"certificate\": {\"joints\": [" + joint("shoulder") + ", " + joint("elbow") + "]}, ");
      std::ofstream(folder + "/written.json") << text;
      const bool good = robot.configure() == CallbackReturn::SUCCESS;
      return good ? std::string("good") : rclcpp::logged().back();
    };
  CHECK(configured("measured", "null", "") == "good");
  CHECK(has(configured("differenced", "null", ""), "a velocity that is differenced;"));
  CHECK(has(configured("measured", "45.0", ""), "measured and filtered"));
  CHECK(has(configured("measured", "null", "{}"), "1 of its claims do not hold"));
}

}  // namespace

int main(int argc, char ** argv)
{
  if (argc != 2) {
    std::puts("which folder?");
    return 2;
  }
  std::setvbuf(stdout, nullptr, _IOLBF, 4096);
  const std::string folder = argv[1];
  record(folder, "observer");
  record(folder, "positions");
  targets(folder);
  brakes(folder);
  refused(folder);
  certified(folder);
  std::printf("%d failures\n", failures);
  return failures == 0 ? 0 : 1;
}
