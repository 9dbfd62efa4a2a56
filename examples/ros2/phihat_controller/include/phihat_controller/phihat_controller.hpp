// phihat's supervisor as a controller of ros2_control.
// (The namespace is not the package's name: phihat.h has a type of that name.)
#ifndef PHIHAT_CONTROLLER__PHIHAT_CONTROLLER_HPP_
#define PHIHAT_CONTROLLER__PHIHAT_CONTROLLER_HPP_

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "controller_interface/chainable_controller_interface.hpp"
#include "diagnostic_msgs/msg/diagnostic_array.hpp"
#include "rclcpp/rclcpp.hpp"
#include "rclcpp_lifecycle/state.hpp"
#include "sensor_msgs/msg/joint_state.hpp"

#include "phihat.h"
#include "phihat_controller/gains_file.hpp"
#include "phihat_controller/mailbox.hpp"

namespace phihat_ros
{

/// Commands `<joint>/effort`, reads `<joint>/position` and `<joint>/velocity`. Where the hardware has an interface for its brakes, commands that too.
///
/// Chained, it follows what another controller writes into `<joint>/position`, `/velocity`, `/acceleration` of this
/// one. Alone, it moves to the targets of `~/reference`. In both cases the reference is shaped to the stated limits.
class PhihatController : public controller_interface::ChainableControllerInterface
{
public:
  controller_interface::CallbackReturn on_init() override;
  controller_interface::CallbackReturn on_configure(const rclcpp_lifecycle::State & previous) override;
  controller_interface::CallbackReturn on_activate(const rclcpp_lifecycle::State & previous) override;
  controller_interface::CallbackReturn on_deactivate(const rclcpp_lifecycle::State & previous) override;
  controller_interface::CallbackReturn on_cleanup(const rclcpp_lifecycle::State & previous) override;

  controller_interface::InterfaceConfiguration command_interface_configuration() const override;
  controller_interface::InterfaceConfiguration state_interface_configuration() const override;

  /// Real time: allocates nothing, waits for nothing, throws nothing.
  controller_interface::return_type update_and_write_commands(
    const rclcpp::Time & time, const rclcpp::Duration & period) override;

protected:
  std::vector<hardware_interface::CommandInterface> on_export_reference_interfaces() override;

  // Humble calls the first, newer releases the second: neither can say `override`.
  controller_interface::return_type update_reference_from_subscribers();
  controller_interface::return_type update_reference_from_subscribers(
    const rclcpp::Time & time, const rclcpp::Duration & period);

private:
  struct Freed
  {
    void operator()(phihat_supervisor * supervisor) const { phihat_supervisor_destroy(supervisor); }
  };
  using Supervisor = std::unique_ptr<phihat_supervisor, Freed>;

  /// What the control loop tells the node.
  struct Told
  {
    phihat_report report{};
    /// Since activation: every event that there was, samples that did not come, commands that did not go out.
    uint32_t events = 0;
    uint64_t lost = 0;
    uint64_t unwritten = 0;
    /// Per joint: position less the reference asked for [rad], and the estimate [N m].
    std::vector<double> error;
    std::vector<double> phi_hat;
  };

  void read_parameters();
  void read_limits();
  void read_brake();
  Supervisor supervisor() const;
  void receive(const sensor_msgs::msg::JointState & target);
  void diagnose();
  bool sense();
  bool refer();
  void command();
  bool write_brake(bool closed);
  void tell(const phihat_report & report);

  // What on_configure found.
  Gains gains_;
  std::vector<phihat_guard> guards_;
  phihat_supervision supervision_{};
  std::vector<double> preset_;
  std::size_t delay_ = 0;
  /// Full name of the command interface of the brakes, 1 closed and 0 open; empty: there is none. It is claimed behind the joints.
  std::string brake_;

  // The node's side.
  rclcpp::Subscription<sensor_msgs::msg::JointState>::SharedPtr subscription_;
  rclcpp::Publisher<diagnostic_msgs::msg::DiagnosticArray>::SharedPtr publisher_;
  rclcpp::TimerBase::SharedPtr timer_;
  uint32_t shown_ = PHIHAT_MODE_IDLE;

  // Between both: targets in, what happened out.
  std::unique_ptr<Mailbox<std::vector<double>>> targets_;
  std::unique_ptr<Mailbox<Told>> told_;

  // The control loop's side. All vectors have their room from on_configure on.
  Supervisor supervisor_;
  bool has_target_ = false;
  uint64_t cycle_ = 0;
  uint64_t now_ns_ = 0;
  uint64_t seen_ = 0;
  uint64_t seen_ns_ = 0;
  uint32_t mode_ = PHIHAT_MODE_IDLE;
  std::vector<double> target_;
  std::vector<double> q_, dq_, q_next_, dq_next_;
  std::vector<double> home_, q_des_, dq_des_, ddq_des_;
  /// Torques that went out, the newest first, one block of joints per sample; and the sum of those that acted since
  /// the last sample that came.
  std::vector<double> sent_, acted_, applied_;
  std::size_t acted_samples_ = 0;
  std::vector<double> tau_, phi_hat_;
  Told news_;
};

}  // namespace phihat_ros

#endif  // PHIHAT_CONTROLLER__PHIHAT_CONTROLLER_HPP_
