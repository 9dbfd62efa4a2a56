#include "phihat_controller/phihat_controller.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "pluginlib/class_list_macros.hpp"

#include "phihat_controller/interfaces.hpp"

namespace phihat_ros
{

using controller_interface::CallbackReturn;
using controller_interface::return_type;

namespace
{

constexpr double NOTHING = std::numeric_limits<double>::quiet_NaN();

/// Entries of the reference per joint: position, velocity, acceleration.
constexpr std::size_t PARTS = 3;
constexpr const char * PART_NAMES[PARTS] = {"position", "velocity", "acceleration"};

/// Lists of one number per joint, and what they set.
struct GuardParameter
{
  const char * name;
  double phihat_guard::* member;
};

constexpr GuardParameter GUARDS[] = {
  {"limits.velocity_max_rad_s", &phihat_guard::velocity_max_rad_s},
  {"limits.position_min_rad", &phihat_guard::position_min_rad},
  {"limits.position_max_rad", &phihat_guard::position_max_rad},
  {"limits.error_stop_rad", &phihat_guard::error_stop_rad},
  {"limits.frozen_travel_rad", &phihat_guard::frozen_travel_rad},
  {"limits.oscillation_nm", &phihat_guard::oscillation_nm},
  {"limits.first_motion_nm", &phihat_guard::first_motion_nm},
  {"reference.velocity_max_rad_s", &phihat_guard::reference_velocity_max_rad_s},
  {"reference.acceleration_max_rad_s2", &phihat_guard::reference_acceleration_max_rad_s2},
  {"reference.jerk_max_rad_s3", &phihat_guard::reference_jerk_max_rad_s3},
};

/// The same of a law's limits, in the place of the certificate's.
struct LimitParameter
{
  const char * name;
  double phihat_joint::* member;
};

constexpr LimitParameter LIMITS[] = {
  {"limits.torque_max_nm", &phihat_joint::torque_max_nm},
  {"limits.torque_rate_max_nm_s", &phihat_joint::torque_rate_max_nm_s},
};

constexpr const char * MODES[] = {"idle", "armed", "holding", "tracking", "safe-stop"};

const char * mode_name(uint32_t mode)
{
  return mode < std::size(MODES) ? MODES[mode] : "unknown";
}

std::string joined(const std::vector<std::string> & names)
{
  std::string all;
  for (const std::string & name : names) {
    all += (all.empty() ? "" : ", ") + name;
  }
  return all.empty() ? "none" : all;
}

}  // namespace

CallbackReturn PhihatController::on_init()
{
  try {
    using Numbers = std::vector<double>;
    auto_declare<std::vector<std::string>>("joints", {});
    auto_declare<std::string>("gains_file", "");
    auto_declare<bool>("uncertified", false);
    auto_declare<int64_t>("torque_delay_samples", -1);
    auto_declare<Numbers>("preset_nm", {});
    auto_declare<std::string>("brake_interface", "");
    auto_declare<double>("brake_closing_s", 0.0);
    for (const LimitParameter & limit : LIMITS) {
      auto_declare<Numbers>(limit.name, {});
    }
    for (const GuardParameter & guard : GUARDS) {
      auto_declare<Numbers>(guard.name, {});
    }
  } catch (const std::exception & why) {
    RCLCPP_ERROR(get_node()->get_logger(), "parameters: %s", why.what());
    return CallbackReturn::ERROR;
  }
  return CallbackReturn::SUCCESS;
}

CallbackReturn PhihatController::on_configure(const rclcpp_lifecycle::State &)
{
  try {
    read_parameters();
    read_limits();
    // Gains and limits are looked at now; the one that runs is made when it starts.
    supervisor();
  } catch (const std::exception & why) {
    RCLCPP_ERROR(get_node()->get_logger(), "%s", why.what());
    return CallbackReturn::FAILURE;
  }
  const std::size_t n = gains_.names.size();
  for (auto * room : {&q_, &dq_, &q_next_, &dq_next_, &home_, &q_des_, &dq_des_, &ddq_des_, &acted_, &applied_,
      &tau_, &phi_hat_, &target_})
  {
    room->assign(n, 0.0);
  }
  sent_.assign(n * (delay_ + 1), 0.0);
  reference_interfaces_.assign(PARTS * n, NOTHING);
  news_ = Told();
  news_.error.assign(n, 0.0);
  news_.phi_hat.assign(n, 0.0);
  targets_ = std::make_unique<Mailbox<std::vector<double>>>(target_);
  told_ = std::make_unique<Mailbox<Told>>(news_);

  subscription_ = get_node()->create_subscription<sensor_msgs::msg::JointState>(
    "~/reference", rclcpp::SystemDefaultsQoS(),
    [this](const std::shared_ptr<const sensor_msgs::msg::JointState> target) {receive(*target);});
  publisher_ = get_node()->create_publisher<diagnostic_msgs::msg::DiagnosticArray>(
    "/diagnostics", rclcpp::SystemDefaultsQoS());
  timer_ = get_node()->create_wall_timer(std::chrono::milliseconds(100), [this] {diagnose();});
  return CallbackReturn::SUCCESS;
}

void PhihatController::read_parameters()
{
  const auto joints = get_node()->get_parameter("joints").as_string_array();
  const std::string path = get_node()->get_parameter("gains_file").as_string();
  if (path.empty()) {
    throw std::runtime_error("gains_file is not set: the gains.json of `phihat design`");
  }
  gains_ = read_gains_file(path);
  if (gains_.names != joints) {
    throw std::runtime_error(
      path + ": the gains are for joints " + joined(gains_.names) + "; parameter joints is " + joined(joints) +
      ": the same names in the same order are expected");
  }
  if (!gains_.reservation.empty() && !get_node()->get_parameter("uncertified").as_bool()) {
    throw std::runtime_error(
      path + ": " + gains_.reservation + ". Parameter uncertified: true runs them without a claim");
  }
  // Humble says 0 where the controller has no rate of its own.
  const double rate = get_update_rate();
  if (rate > 0.0 && std::abs(rate - gains_.rate_hz) > 1e-9 * gains_.rate_hz) {
    throw std::runtime_error(
      path + ": the gains are for a loop at " + std::to_string(gains_.rate_hz) + " Hz; this controller runs at " +
      std::to_string(rate) + " Hz");
  }
  const int64_t delay = get_node()->get_parameter("torque_delay_samples").as_int();
  if (delay < -1 || delay > 64) {
    throw std::runtime_error("torque_delay_samples is " + std::to_string(delay) + "; -1 (as the gains say) to 64");
  }
  delay_ = delay >= 0 ? static_cast<std::size_t>(delay) :
    *std::max_element(gains_.delay_samples.begin(), gains_.delay_samples.end());
}

void PhihatController::read_limits()
{
  const std::size_t n = gains_.names.size();
  const auto list = [this, n](const char * name) {
      auto values = get_node()->get_parameter(name).as_double_array();
      if (!values.empty() && values.size() != n) {
        throw std::runtime_error(
          std::string(name) + " has " + std::to_string(values.size()) + " entries; " + std::to_string(n) +
          " are expected, one per joint, or none");
      }
      return values;
    };
  for (const LimitParameter & limit : LIMITS) {
    const auto values = list(limit.name);
    for (std::size_t i = 0; i < values.size(); ++i) {
      gains_.joints[i].*limit.member = values[i];
    }
  }
  phihat_guard guard;
  guard.size = sizeof guard;
  phihat_guard_default(&guard);
  guards_.assign(n, guard);
  for (const GuardParameter & parameter : GUARDS) {
    const auto values = list(parameter.name);
    for (std::size_t i = 0; i < values.size(); ++i) {
      guards_[i].*parameter.member = values[i];
    }
  }
  preset_ = list("preset_nm");
  preset_.resize(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(gains_.joints[i].torque_max_nm)) {
      throw std::runtime_error(
        "joint " + gains_.names[i] + ": no torque limit, neither in the certificate nor in limits.torque_max_nm");
    }
    const phihat_guard & own = guards_[i];
    if (!std::isfinite(own.reference_velocity_max_rad_s) || !std::isfinite(own.reference_acceleration_max_rad_s2) ||
      !std::isfinite(own.reference_jerk_max_rad_s3))
    {
      throw std::runtime_error(
        "joint " + gains_.names[i] + ": reference.velocity_max_rad_s, reference.acceleration_max_rad_s2 and "
        "reference.jerk_max_rad_s3 are expected: every reference is shaped to them");
    }
    if (!std::isfinite(preset_[i])) {
      throw std::runtime_error("joint " + gains_.names[i] + ": preset_nm is not finite");
    }
  }
  supervision_.size = sizeof supervision_;
  phihat_supervision_default(static_cast<uint64_t>(std::llround(1e9 / gains_.rate_hz)), &supervision_);
  read_brake();
}

void PhihatController::read_brake()
{
  const double closing = get_node()->get_parameter("brake_closing_s").as_double();
  brake_ = get_node()->get_parameter("brake_interface").as_string();
  // With a closing time the law gives way to the brakes: somebody has to close them.
  if (brake_.empty() && closing == 0.0) {
    return;
  }
  if (brake_.empty()) {
    throw std::runtime_error("brake_closing_s is set, and brake_interface names no command interface that closes the brakes");
  }
  if (!std::isfinite(closing) || closing <= 0.0 || closing > 10.0) {
    throw std::runtime_error(
      "brake_closing_s is " + std::to_string(closing) + "; with brake_interface " + brake_ +
      ", more than 0 s and at most 10 s are expected");
  }
  const std::size_t slash = brake_.rfind('/');
  if (slash == std::string::npos || slash == 0 || slash + 1 == brake_.size()) {
    throw std::runtime_error("brake_interface is " + brake_ + "; the name of a command interface is expected, as brake/engaged");
  }
  supervision_.brake_closing_s = closing;
}

PhihatController::Supervisor PhihatController::supervisor() const
{
  phihat_supervisor * made = nullptr;
  phihat_error error;
  error.size = sizeof error;
  const phihat_status status = phihat_supervisor_create(
    gains_.joints.data(), guards_.data(), gains_.joints.size(), &supervision_, &made, &error);
  if (status != PHIHAT_STATUS_OK) {
    const std::string joint = error.joint < gains_.names.size() ? " (" + gains_.names[error.joint] + ")" : "";
    throw std::runtime_error("gains or limits are refused: " + std::string(error.text) + joint);
  }
  return Supervisor(made);
}

controller_interface::InterfaceConfiguration PhihatController::command_interface_configuration() const
{
  controller_interface::InterfaceConfiguration claimed;
  claimed.type = controller_interface::interface_configuration_type::INDIVIDUAL;
  for (const std::string & joint : gains_.names) {
    claimed.names.push_back(joint + "/effort");
  }
  if (!brake_.empty()) {
    claimed.names.push_back(brake_);
  }
  return claimed;
}

controller_interface::InterfaceConfiguration PhihatController::state_interface_configuration() const
{
  controller_interface::InterfaceConfiguration claimed;
  claimed.type = controller_interface::interface_configuration_type::INDIVIDUAL;
  for (const std::string & joint : gains_.names) {
    claimed.names.push_back(joint + "/position");
    claimed.names.push_back(joint + "/velocity");
  }
  return claimed;
}

std::vector<hardware_interface::CommandInterface> PhihatController::on_export_reference_interfaces()
{
  std::vector<hardware_interface::CommandInterface> exported;
  for (std::size_t i = 0; i < gains_.names.size(); ++i) {
    for (std::size_t part = 0; part < PARTS; ++part) {
      exported.emplace_back(
        std::string(get_node()->get_name()), gains_.names[i] + "/" + PART_NAMES[part],
        &reference_interfaces_[PARTS * i + part]);
    }
  }
  return exported;
}

CallbackReturn PhihatController::on_activate(const rclcpp_lifecycle::State &)
{
  const auto commands = command_interface_configuration().names;
  const auto states = state_interface_configuration().names;
  const auto same = [this](const auto & interfaces, const std::vector<std::string> & names) {
      const auto named = [](const auto & own, const std::string & name) {return own.get_name() == name;};
      const bool all = interfaces.size() == names.size() &&
        std::equal(interfaces.begin(), interfaces.end(), names.begin(), named);
      if (!all) {
        RCLCPP_ERROR(get_node()->get_logger(), "the interfaces are not %s", joined(names).c_str());
      }
      return all;
    };
  if (!same(command_interfaces_, commands) || !same(state_interfaces_, states)) {
    return CallbackReturn::FAILURE;
  }
  try {
    supervisor_ = supervisor();
  } catch (const std::exception & why) {
    RCLCPP_ERROR(get_node()->get_logger(), "%s", why.what());
    return CallbackReturn::FAILURE;
  }
  for (auto * zeroed : {&sent_, &acted_, &applied_, &tau_, &phi_hat_, &home_, &q_des_, &dq_des_, &ddq_des_,
      &news_.error, &news_.phi_hat})
  {
    std::fill(zeroed->begin(), zeroed->end(), 0.0);
  }
  // Before the first sample nothing is known, and a number would be believed.
  for (auto * unknown : {&q_, &dq_, &reference_interfaces_}) {
    std::fill(unknown->begin(), unknown->end(), NOTHING);
  }
  // A target from before is not meant for now.
  targets_->take();
  has_target_ = false;
  cycle_ = now_ns_ = seen_ = seen_ns_ = 0;
  acted_samples_ = 0;
  mode_ = PHIHAT_MODE_IDLE;
  news_.events = 0;
  news_.lost = news_.unwritten = 0;
  return CallbackReturn::SUCCESS;
}

CallbackReturn PhihatController::on_deactivate(const rclcpp_lifecycle::State &)
{
  if (!write_brake(true)) {
    RCLCPP_ERROR(get_node()->get_logger(), "%s could not be set to 1: the brakes are not asked for", brake_.c_str());
  }
  // A torque that nobody looks after any more would accelerate the arm without end.
  for (std::size_t i = 0; i < gains_.names.size() && i < command_interfaces_.size(); ++i) {
    auto & effort = command_interfaces_[i];
    if (!write_to(effort, 0.0)) {
      RCLCPP_ERROR(get_node()->get_logger(), "%s could not be set to zero", effort.get_name().c_str());
    }
  }
  supervisor_.reset();
  return CallbackReturn::SUCCESS;
}

CallbackReturn PhihatController::on_cleanup(const rclcpp_lifecycle::State &)
{
  timer_.reset();
  publisher_.reset();
  subscription_.reset();
  supervisor_.reset();
  return CallbackReturn::SUCCESS;
}

return_type PhihatController::update_reference_from_subscribers()
{
  if (targets_->take()) {
    has_target_ = true;
    std::copy(targets_->newest().begin(), targets_->newest().end(), target_.begin());
  }
  // The first step of tracking begins where the arm is held; the shaper takes it from there.
  const bool moves = has_target_ && mode_ == PHIHAT_MODE_TRACKING;
  for (std::size_t i = 0; i < target_.size(); ++i) {
    const double q = moves ? target_[i] : home_[i];
    reference_interfaces_[PARTS * i] = has_target_ ? q : NOTHING;
    reference_interfaces_[PARTS * i + 1] = 0.0;
    reference_interfaces_[PARTS * i + 2] = 0.0;
  }
  return return_type::OK;
}

return_type PhihatController::update_reference_from_subscribers(const rclcpp::Time &, const rclcpp::Duration &)
{
  return update_reference_from_subscribers();
}

/// Takes this cycle's sample, if all of it came.
bool PhihatController::sense()
{
  const std::size_t n = q_.size();
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    q_next_[i] = value_of(state_interfaces_[2 * i]);
    dq_next_[i] = value_of(state_interfaces_[2 * i + 1]);
    sum += q_next_[i] + dq_next_[i];
  }
  // The torque of the period that has just ended.
  for (std::size_t i = 0; i < n; ++i) {
    acted_[i] += sent_[delay_ * n + i];
  }
  ++acted_samples_;
  if (std::isnan(sum)) {
    return false;
  }
  q_.swap(q_next_);
  dq_.swap(dq_next_);
  for (std::size_t i = 0; i < n; ++i) {
    applied_[i] = acted_[i] / static_cast<double>(acted_samples_);
    acted_[i] = 0.0;
  }
  acted_samples_ = 0;
  return true;
}

/// Takes the reference; whether there is one. Where it says no velocity or acceleration, these are zero.
bool PhihatController::refer()
{
  const auto or_zero = [](double x) {return std::isnan(x) ? 0.0 : x;};
  bool there = true;
  for (std::size_t i = 0; i < q_.size(); ++i) {
    there = there && !std::isnan(reference_interfaces_[PARTS * i]);
  }
  for (std::size_t i = 0; there && i < q_.size(); ++i) {
    q_des_[i] = reference_interfaces_[PARTS * i];
    dq_des_[i] = or_zero(reference_interfaces_[PARTS * i + 1]);
    ddq_des_[i] = or_zero(reference_interfaces_[PARTS * i + 2]);
  }
  return there;
}

/// Writes the torques, and keeps what the robot was told.
void PhihatController::command()
{
  const std::size_t n = q_.size();
  std::copy_backward(sent_.begin(), sent_.end() - static_cast<std::ptrdiff_t>(n), sent_.end());
  for (std::size_t i = 0; i < n; ++i) {
    if (write_to(command_interfaces_[i], tau_[i])) {
      sent_[i] = tau_[i];
    } else {
      // The robot goes on with what it was told before, which is there already where the delay is none.
      ++news_.unwritten;
      sent_[i] = delay_ > 0 ? sent_[n + i] : sent_[i];
    }
  }
}

/// Tells the hardware whether the brakes are to be closed; whether it went out. Without an interface there is nobody to tell.
bool PhihatController::write_brake(bool closed)
{
  const std::size_t at = gains_.names.size();
  return brake_.empty() || at >= command_interfaces_.size() || write_to(command_interfaces_[at], closed ? 1.0 : 0.0);
}

return_type PhihatController::update_and_write_commands(const rclcpp::Time &, const rclcpp::Duration & period)
{
  if (!supervisor_) {
    return return_type::ERROR;
  }
  ++cycle_;
  // The robot's clock may jump; what has been measured between two cycles does not.
  now_ns_ += static_cast<uint64_t>(std::max<int64_t>(period.nanoseconds(), 0));
  if (sense()) {
    seen_ = cycle_;
    seen_ns_ = now_ns_;
    if (mode_ == PHIHAT_MODE_IDLE || mode_ == PHIHAT_MODE_ARMED) {
      std::copy(q_.begin(), q_.end(), home_.begin());
    }
  } else {
    ++news_.lost;
  }
  const bool wanted = refer();
  phihat_request request{};
  request.size = sizeof request;
  request.sequence = seen_;
  request.t_ns = seen_ns_;
  request.now_ns = now_ns_;
  request.preset = preset_.data();
  switch (mode_) {
    case PHIHAT_MODE_IDLE: request.mode = PHIHAT_REQUEST_ARM; break;
    case PHIHAT_MODE_ARMED: request.mode = PHIHAT_REQUEST_HOLD; break;
    case PHIHAT_MODE_SAFE_STOP: request.mode = PHIHAT_REQUEST_STOP; break;
    default: request.mode = wanted ? PHIHAT_REQUEST_TRACK : PHIHAT_REQUEST_HOLD; break;
  }
  const phihat_sample sample{
    sizeof(phihat_sample), q_.size(), q_.data(), dq_.data(), applied_.data(), q_des_.data(), dq_des_.data(),
    ddq_des_.data()};
  const phihat_command command{sizeof(phihat_command), q_.size(), tau_.data(), phi_hat_.data(), nullptr};
  phihat_report report{};
  report.size = sizeof report;
  if (phihat_supervisor_step(supervisor_.get(), &sample, &request, &command, &report) != PHIHAT_STATUS_OK) {
    write_brake(true);
    return return_type::ERROR;
  }
  mode_ = report.mode;
  this->command();
  if (!write_brake(report.brake != 0)) {
    ++news_.unwritten;
  }
  tell(report);
  return return_type::OK;
}

void PhihatController::tell(const phihat_report & report)
{
  news_.report = report;
  news_.events |= report.events;
  for (std::size_t i = 0; i < q_.size(); ++i) {
    news_.error[i] = report.mode == PHIHAT_MODE_TRACKING ? q_[i] - q_des_[i] : 0.0;
    news_.phi_hat[i] = phi_hat_[i];
  }
  told_->place() = news_;
  told_->send();
}

/// A target of `~/reference`: a position for every joint, in any order.
void PhihatController::receive(const sensor_msgs::msg::JointState & target)
{
  std::vector<double> & place = targets_->place();
  if (target.name.size() != place.size() || target.position.size() != place.size()) {
    RCLCPP_WARN(
      get_node()->get_logger(), "~/reference: %zu names and %zu positions; %zu of each are expected",
      target.name.size(), target.position.size(), place.size());
    return;
  }
  for (std::size_t i = 0; i < place.size(); ++i) {
    const auto at = std::find(target.name.begin(), target.name.end(), gains_.names[i]);
    const std::size_t which = static_cast<std::size_t>(at - target.name.begin());
    if (at == target.name.end() || !std::isfinite(target.position[which])) {
      RCLCPP_WARN(get_node()->get_logger(), "~/reference: no position for joint %s", gains_.names[i].c_str());
      return;
    }
    place[i] = target.position[which];
  }
  targets_->send();
}

/// Ten times a second, in the node's thread.
void PhihatController::diagnose()
{
  if (!told_->take()) {
    return;
  }
  const Told & told = told_->newest();
  const phihat_report & report = told.report;
  const bool stopped = report.mode == PHIHAT_MODE_SAFE_STOP;
  const std::string fault = report.fault != nullptr ? report.fault : "";
  const std::string blamed = report.fault_joint < gains_.names.size() ? gains_.names[report.fault_joint] : "";
  if (report.mode != shown_) {
    shown_ = report.mode;
    if (stopped) {
      RCLCPP_ERROR(get_node()->get_logger(), "safe stop: %s %s", fault.c_str(), blamed.c_str());
    } else {
      RCLCPP_INFO(get_node()->get_logger(), "%s", mode_name(report.mode));
    }
  }
  diagnostic_msgs::msg::DiagnosticStatus status;
  status.name = std::string(get_node()->get_name()) + ": phihat";
  using Level = diagnostic_msgs::msg::DiagnosticStatus;
  status.level = stopped ? Level::ERROR : report.lost > 0 || report.refusal != nullptr ? Level::WARN : Level::OK;
  status.message = std::string(mode_name(report.mode)) + (fault.empty() ? "" : ": " + fault);
  const auto add = [&status](const std::string & key, const std::string & value) {
      diagnostic_msgs::msg::KeyValue entry;
      entry.key = key;
      entry.value = value;
      status.values.push_back(entry);
    };
  add("mode", mode_name(report.mode));
  add("fault", fault);
  add("fault joint", blamed);
  add("request refused", report.refusal != nullptr ? report.refusal : "");
  add("brakes wanted", report.brake != 0 ? "yes" : "no");
  add("brakes told by", brake_.empty() ? "none" : brake_);
  add("samples missed in a row", std::to_string(report.misses));
  add("samples missed of the last 64", std::to_string(report.lost));
  add("samples missed since activation", std::to_string(told.lost));
  add("commands not written since activation", std::to_string(told.unwritten));
  std::vector<std::string> events;
  for (uint32_t bit = 0; phihat_event_text(bit) != nullptr; ++bit) {
    if ((told.events >> bit & 1u) != 0) {
      events.emplace_back(phihat_event_text(bit));
    }
  }
  add("events since activation", joined(events));
  for (std::size_t i = 0; i < gains_.names.size(); ++i) {
    add(gains_.names[i] + " error [rad]", std::to_string(told.error[i]));
    add(gains_.names[i] + " phi_hat [N m]", std::to_string(told.phi_hat[i]));
  }
  diagnostic_msgs::msg::DiagnosticArray message;
  message.header.stamp = get_node()->now();
  message.status.push_back(status);
  publisher_->publish(message);
}

}  // namespace phihat_ros

PLUGINLIB_EXPORT_CLASS(phihat_ros::PhihatController, controller_interface::ChainableControllerInterface)
