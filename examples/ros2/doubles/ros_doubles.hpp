// Stand-ins for what phihat_controller uses of ROS 2 and ros2_control, so that it can be compiled and run without
// either. Written from the documented interfaces; each says no more than the plugin needs, and a test can look inside.
//
// Two releases: PHIHAT_DOUBLE_JAZZY is defined (interfaces may be empty, writing may fail, references are updated with
// a time) or it is not (Humble).
#ifndef PHIHAT_ROS_DOUBLES_HPP_
#define PHIHAT_ROS_DOUBLES_HPP_

#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace rclcpp
{

/// The lines that were logged, for a test to read.
inline std::vector<std::string> & logged()
{
  static std::vector<std::string> lines;
  return lines;
}

struct Logger {};

inline void log(const Logger &, const char * format, ...)
{
  char line[4096];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  logged().emplace_back(line);
}

#define RCLCPP_INFO(logger, ...) rclcpp::log(logger, __VA_ARGS__)
#define RCLCPP_WARN(logger, ...) rclcpp::log(logger, __VA_ARGS__)
#define RCLCPP_ERROR(logger, ...) rclcpp::log(logger, __VA_ARGS__)

class Time
{
public:
  explicit Time(int64_t nanoseconds = 0) : nanoseconds_(nanoseconds) {}
  int64_t nanoseconds() const { return nanoseconds_; }

private:
  int64_t nanoseconds_;
};

class Duration
{
public:
  explicit Duration(int64_t nanoseconds = 0) : nanoseconds_(nanoseconds) {}
  int64_t nanoseconds() const { return nanoseconds_; }

private:
  int64_t nanoseconds_;
};

struct QoS {};
struct SystemDefaultsQoS : QoS {};

class Parameter
{
public:
  using Value = std::variant<
    bool, int64_t, double, std::string, std::vector<double>, std::vector<std::string>>;

  explicit Parameter(Value value = false) : value_(std::move(value)) {}
  bool as_bool() const { return std::get<bool>(value_); }
  int64_t as_int() const { return std::get<int64_t>(value_); }
  double as_double() const { return std::get<double>(value_); }
  std::string as_string() const { return std::get<std::string>(value_); }
  std::vector<double> as_double_array() const { return std::get<std::vector<double>>(value_); }
  std::vector<std::string> as_string_array() const { return std::get<std::vector<std::string>>(value_); }

  template<class T>
  T get_value() const { return std::get<T>(value_); }

private:
  Value value_;
};

template<class Message>
struct Subscription
{
  using SharedPtr = std::shared_ptr<Subscription>;
  std::string topic;
  std::function<void(std::shared_ptr<const Message>)> callback;
};

template<class Message>
struct Publisher
{
  using SharedPtr = std::shared_ptr<Publisher>;
  std::string topic;
  std::vector<Message> published;
  void publish(const Message & message) { published.push_back(message); }
};

struct TimerBase
{
  using SharedPtr = std::shared_ptr<TimerBase>;
  std::function<void()> callback;
};

}  // namespace rclcpp

namespace builtin_interfaces::msg
{
struct Time
{
  int32_t sec = 0;
  uint32_t nanosec = 0;
  Time & operator=(const rclcpp::Time & time)
  {
    sec = static_cast<int32_t>(time.nanoseconds() / 1000000000);
    nanosec = static_cast<uint32_t>(time.nanoseconds() % 1000000000);
    return *this;
  }
};
}  // namespace builtin_interfaces::msg

namespace std_msgs::msg
{
struct Header
{
  builtin_interfaces::msg::Time stamp;
  std::string frame_id;
};
}  // namespace std_msgs::msg

namespace sensor_msgs::msg
{
struct JointState
{
  std_msgs::msg::Header header;
  std::vector<std::string> name;
  std::vector<double> position, velocity, effort;
};
}  // namespace sensor_msgs::msg

namespace diagnostic_msgs::msg
{
struct KeyValue
{
  std::string key, value;
};

struct DiagnosticStatus
{
  static constexpr unsigned char OK = 0, WARN = 1, ERROR = 2, STALE = 3;
  unsigned char level = OK;
  std::string name, message, hardware_id;
  std::vector<KeyValue> values;
};

struct DiagnosticArray
{
  std_msgs::msg::Header header;
  std::vector<DiagnosticStatus> status;
};
}  // namespace diagnostic_msgs::msg

namespace rclcpp_lifecycle
{

class State {};

namespace node_interfaces
{
struct LifecycleNodeInterface
{
  enum class CallbackReturn : uint8_t { SUCCESS = 97, FAILURE = 98, ERROR = 99 };

  virtual ~LifecycleNodeInterface() = default;
  virtual CallbackReturn on_configure(const State &) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_cleanup(const State &) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_activate(const State &) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_deactivate(const State &) { return CallbackReturn::SUCCESS; }
};
}  // namespace node_interfaces

class LifecycleNode
{
public:
  std::string name = "phihat";
  std::map<std::string, rclcpp::Parameter> parameters;
  std::map<std::string, std::shared_ptr<void>> topics;
  std::vector<rclcpp::TimerBase::SharedPtr> timers;

  const char * get_name() const { return name.c_str(); }
  rclcpp::Logger get_logger() const { return {}; }
  rclcpp::Time now() const { return rclcpp::Time(0); }
  bool has_parameter(const std::string & key) const { return parameters.count(key) != 0; }

  rclcpp::Parameter get_parameter(const std::string & key) const
  {
    const auto found = parameters.find(key);
    if (found == parameters.end()) {
      throw std::runtime_error("parameter " + key + " is not declared");
    }
    return found->second;
  }

  template<class T>
  T declare_parameter(const std::string & key, const T & value)
  {
    parameters[key] = rclcpp::Parameter(value);
    return value;
  }

  template<class Message, class Callback>
  typename rclcpp::Subscription<Message>::SharedPtr create_subscription(
    const std::string & topic, const rclcpp::QoS &, Callback callback)
  {
    auto made = std::make_shared<rclcpp::Subscription<Message>>();
    made->topic = topic;
    made->callback = callback;
    topics[topic] = made;
    return made;
  }

  template<class Message>
  typename rclcpp::Publisher<Message>::SharedPtr create_publisher(const std::string & topic, const rclcpp::QoS &)
  {
    auto made = std::make_shared<rclcpp::Publisher<Message>>();
    made->topic = topic;
    topics[topic] = made;
    return made;
  }

  template<class Period>
  rclcpp::TimerBase::SharedPtr create_wall_timer(Period, std::function<void()> callback)
  {
    timers.push_back(std::make_shared<rclcpp::TimerBase>());
    timers.back()->callback = std::move(callback);
    return timers.back();
  }
};

}  // namespace rclcpp_lifecycle

namespace hardware_interface
{

/// A value of the robot that has a name. `blocked`: whoever asks just now gets nothing (Jazzy).
class Handle
{
public:
  Handle(const std::string & prefix, const std::string & name, double * value)
  : prefix_(prefix), name_(name), value_(value) {}

  std::string get_name() const { return prefix_ + "/" + name_; }
  const std::string & get_prefix_name() const { return prefix_; }
  const std::string & get_interface_name() const { return name_; }
  double & value() const { return *value_; }
  bool blocked = false;

private:
  std::string prefix_, name_;
  double * value_;
};

struct StateInterface : Handle { using Handle::Handle; };
struct CommandInterface : Handle { using Handle::Handle; };

template<class Interface>
class Loaned
{
public:
  explicit Loaned(Interface & interface) : interface_(interface) {}
  std::string get_name() const { return interface_.get_name(); }

#ifdef PHIHAT_DOUBLE_JAZZY
  template<class T = double>
  [[nodiscard]] std::optional<T> get_optional(unsigned = 10) const
  {
    if (interface_.blocked) {
      return std::nullopt;
    }
    return interface_.value();
  }
#else
  double get_value() const { return interface_.value(); }
#endif

protected:
  Interface & interface_;
};

using LoanedStateInterface = Loaned<StateInterface>;

class LoanedCommandInterface : public Loaned<CommandInterface>
{
public:
  using Loaned<CommandInterface>::Loaned;

#ifdef PHIHAT_DOUBLE_JAZZY
  template<class T>
  [[nodiscard]] bool set_value(const T & value, unsigned = 10)
  {
    if (interface_.blocked) {
      return false;
    }
    interface_.value() = value;
    return true;
  }
#else
  void set_value(double value) { interface_.value() = value; }
#endif
};

}  // namespace hardware_interface

namespace controller_interface
{

using CallbackReturn = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;

enum class return_type : uint8_t { OK = 0, ERROR = 1 };

enum class interface_configuration_type : uint8_t { ALL = 0, INDIVIDUAL = 1, NONE = 2 };

struct InterfaceConfiguration
{
  interface_configuration_type type = interface_configuration_type::NONE;
  std::vector<std::string> names = {};
};

class ControllerInterfaceBase : public rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface
{
public:
  virtual InterfaceConfiguration command_interface_configuration() const = 0;
  virtual InterfaceConfiguration state_interface_configuration() const = 0;
  virtual CallbackReturn on_init() = 0;
  virtual return_type update(const rclcpp::Time & time, const rclcpp::Duration & period) = 0;

  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> get_node() const { return node_; }
  unsigned int get_update_rate() const { return update_rate; }

  template<class T>
  auto auto_declare(const std::string & name, const T & value)
  {
    if (!get_node()->has_parameter(name)) {
      return get_node()->template declare_parameter<T>(name, value);
    }
    return get_node()->get_parameter(name).template get_value<T>();
  }

  void assign_interfaces(
    std::vector<hardware_interface::LoanedCommandInterface> && commands,
    std::vector<hardware_interface::LoanedStateInterface> && states)
  {
    // References inside: not assigned, made anew.
    command_interfaces_.clear();
    state_interfaces_.clear();
    for (auto & command : commands) {
      command_interfaces_.push_back(command);
    }
    for (auto & state : states) {
      state_interfaces_.push_back(state);
    }
  }

  unsigned int update_rate = 0;

protected:
  std::vector<hardware_interface::LoanedCommandInterface> command_interfaces_;
  std::vector<hardware_interface::LoanedStateInterface> state_interfaces_;

private:
  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node_ = std::make_shared<rclcpp_lifecycle::LifecycleNode>();
};

class ChainableControllerInterface : public ControllerInterfaceBase
{
public:
  return_type update(const rclcpp::Time & time, const rclcpp::Duration & period) final
  {
    if (!chained) {
#ifdef PHIHAT_DOUBLE_JAZZY
      const return_type updated = update_reference_from_subscribers(time, period);
#else
      const return_type updated = update_reference_from_subscribers();
#endif
      if (updated != return_type::OK) {
        return updated;
      }
    }
    return update_and_write_commands(time, period);
  }

  std::vector<hardware_interface::CommandInterface> export_reference_interfaces()
  {
    auto exported = on_export_reference_interfaces();
    if (exported.size() != reference_interfaces_.size()) {
      throw std::runtime_error("as many reference interfaces as values are expected");
    }
    return exported;
  }

  bool chained = false;

protected:
  virtual std::vector<hardware_interface::CommandInterface> on_export_reference_interfaces() = 0;
#ifdef PHIHAT_DOUBLE_JAZZY
  virtual return_type update_reference_from_subscribers(const rclcpp::Time & time, const rclcpp::Duration & period) = 0;
#else
  virtual return_type update_reference_from_subscribers() = 0;
#endif
  virtual return_type update_and_write_commands(const rclcpp::Time & time, const rclcpp::Duration & period) = 0;

  std::vector<double> reference_interfaces_;
};

}  // namespace controller_interface

/// Where pluginlib would enter the class: a function that makes one.
#define PLUGINLIB_EXPORT_CLASS(Class, Base) \
  std::shared_ptr<Base> make_plugin(); \
  std::shared_ptr<Base> make_plugin() {return std::make_shared<Class>();}

#endif  // PHIHAT_ROS_DOUBLES_HPP_
