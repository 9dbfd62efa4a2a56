/**
 * @file phihat.h
 * The phihat controller: robust-adaptive joint torque control. C99 and C++17; made by cbindgen from
 * crates/phihat-c, do not edit.
 *
 *     tau = M (ddq_des - K_d de - K_p e) + phi_hat,      e = q - q_des (measured minus desired)
 *
 * or, of PHIHAT_FORM_POSITIONS, what phihat_joint says.
 *
 * SI units and radians; for prismatic joints read m for rad and N for N m. Arrays have one entry per
 * joint, in the order of the joints given to phihat_controller_create().
 *
 * Every structure begins with its own size, set by the caller (`.size = sizeof(phihat_joint)`), so that
 * later versions can add members at the end. What was compiled with a header whose phihat_joint ended before
 * `correction`, before `sections` or before `torque_filter_hz` runs as it did. Every function answers a phihat_status.
 *
 * phihat_controller is the law and its limits. phihat_supervisor puts around it what a real arm needs: a
 * guard for bad, late and lost samples, joint limits, modes with a latched safe stop, bumpless starts.
 * phihat_gate is the last thing before a torque leaves, behind gravity compensation and whatever else is added.
 *
 * Real time: the functions ..._create() allocate, ..._destroy() free, nothing else touches the heap, waits,
 * or calls the system. Different handles may be used by different threads; one handle by one thread at a
 * time.
 *
 * Not a safety function: research and engineering software, no replacement for an emergency stop.
 */

#ifndef PHIHAT_H
#define PHIHAT_H

#include <stddef.h>
#include <stdint.h>

/**
 * Highest order of the estimator.
 */
#define PHIHAT_ORDER_MAX 4

/**
 * Most entries of a correction: of order 3, two more than that.
 */
#define PHIHAT_CORRECTION_MAX 5

/**
 * Longest delay that PHIHAT_FORM_POSITIONS predicts across [samples].
 */
#define PHIHAT_DELAY_MAX 4

/**
 * Most sections of an innovation filter.
 */
#define PHIHAT_SECTIONS_MAX 2

/**
 * Form of the law: a disturbance observer fed with the torque that acted. The default.
 */
#define PHIHAT_FORM_OBSERVER 0

/**
 * Form of the law: the paper's integrals of the error, for reproduction; winds up under saturation.
 */
#define PHIHAT_FORM_LITERAL 1

/**
 * Form of the law: an observer from the position and the torque that acted. See phihat_joint.
 */
#define PHIHAT_FORM_POSITIONS 2

/**
 * Flag of a command: the torque limit acted.
 */
#define PHIHAT_SATURATED 1

/**
 * Flag of a command: the torque-rate limit acted.
 */
#define PHIHAT_RATE_LIMITED 2

/**
 * Flag of a command: the sample was not finite or beyond +-2^32; the last torque is held, the state untouched.
 */
#define PHIHAT_REFUSED 4

/**
 * Request: no torque; from armed and from a stop only.
 */
#define PHIHAT_REQUEST_IDLE 0

/**
 * Request: get ready; counts when it is new.
 */
#define PHIHAT_REQUEST_ARM 1

/**
 * Request: hold the pose.
 */
#define PHIHAT_REQUEST_HOLD 2

/**
 * Request: follow the reference.
 */
#define PHIHAT_REQUEST_TRACK 3

/**
 * Request: safe stop.
 */
#define PHIHAT_REQUEST_STOP 4

/**
 * Mode: no torque.
 */
#define PHIHAT_MODE_IDLE 0

/**
 * Mode: ready; the held torque and damping act.
 */
#define PHIHAT_MODE_ARMED 1

/**
 * Mode: the law holds a pose.
 */
#define PHIHAT_MODE_HOLDING 2

/**
 * Mode: the law follows the reference.
 */
#define PHIHAT_MODE_TRACKING 3

/**
 * Mode: latched; the law brings the arm to rest and holds it there, then the brakes. Left by a new PHIHAT_REQUEST_ARM.
 */
#define PHIHAT_MODE_SAFE_STOP 4

/**
 * Result of a call.
 */
typedef enum phihat_status {
  /**
   * Done.
   */
  PHIHAT_STATUS_OK = 0,
  /**
   * The sample held something that is not finite, or beyond +-2^32 (4.3e9), or led to what is not finite:
   * the command holds the last torque of every joint, the controller's state is untouched.
   */
  PHIHAT_STATUS_REFUSED = 1,
  /**
   * A pointer that must not be null is.
   */
  PHIHAT_STATUS_NULL_POINTER = 2,
  /**
   * A structure's `size` is not sizeof() of it, in this version of the header or in an older one that this
   * library still reads.
   */
  PHIHAT_STATUS_WRONG_SIZE = 3,
  /**
   * The number of joints is 0, or not that of the controller.
   */
  PHIHAT_STATUS_WRONG_JOINTS = 4,
  /**
   * A gain or limit is not possible; phihat_error says which.
   */
  PHIHAT_STATUS_BAD_GAIN = 5,
  /**
   * There is no memory left.
   */
  PHIHAT_STATUS_OUT_OF_MEMORY = 6,
  /**
   * A mistake of this library: please report it.
   */
  PHIHAT_STATUS_INTERNAL = 7,
  /**
   * An option is not possible; phihat_error says which.
   */
  PHIHAT_STATUS_BAD_OPTION = 8,
} phihat_status;

/**
 * A controller for an arm: gains, what they remember, and room for one sample.
 */
typedef struct phihat_controller phihat_controller;

/**
 * A gate for an arm's torques, and room for one sample.
 */
typedef struct phihat_gate phihat_gate;

/**
 * A controller under supervision, for an arm.
 */
typedef struct phihat_supervisor phihat_supervisor;

/**
 * Gains and limits of one joint. What a form does not use is not looked at.
 *
 * PHIHAT_FORM_OBSERVER and PHIHAT_FORM_LITERAL use `a`. PHIHAT_FORM_POSITIONS uses the members from
 * `correction` on instead, l = correction, v = velocity_correction, g = share, d = delay_samples, and of
 * each section c = section_rates, b = section_weights_per_s2; at sample k:
 *
 *   z     = estimates of e, de, phi, ... at the last sample, carried on by the torque that acted less its ff
 *   nu    = q - q_des - z_e
 *   z    += l nu                                   (and v (dq - dq_des - z_de), where v is not zero)
 *   x, y  = x + y, y + nu - c_0 x - c_1 y          of each section, from 0, 0 at the first sample
 *   z+    = z carried on through the d torques that are on their way, and phi by T (1/g - 1) more
 *   ff    = M ddq_des
 *   r     = the last torque, as the limits let it through, less its ff
 *   want  = phi+ - M (K_d de+ + K_p e+) + M (sum of b_0 x + b_1 y over the sections)
 *   tau   = ff + r + g (want - r)
 *
 * tau acts from sample k + d to k + d + 1. Its feed-forward ff enters with the reference, so that ddq_des of
 * phihat_sample is the mean of that interval.
 */
typedef struct phihat_joint {
  /**
   * sizeof(phihat_joint).
   */
  size_t size;
  /**
   * Nominal inertia M, positive [kg m^2].
   */
  double inertia_kg_m2;
  /**
   * Outer loop K_p, positive [1/s^2].
   */
  double kp_per_s2;
  /**
   * Outer loop K_d, positive [1/s].
   */
  double kd_per_s;
  /**
   * Estimator coefficients a_0 ... a_(order-1), positive; a_i in [1/s^(order-i)]. Not of PHIHAT_FORM_POSITIONS.
   */
  double a[PHIHAT_ORDER_MAX];
  /**
   * Order of the estimator, 1 ... PHIHAT_ORDER_MAX; of PHIHAT_FORM_POSITIONS 1 ... 3.
   */
  uint32_t order;
  /**
   * PHIHAT_FORM_OBSERVER, PHIHAT_FORM_LITERAL or PHIHAT_FORM_POSITIONS.
   */
  uint32_t form;
  /**
   * Largest |tau|, positive [N m]; INFINITY: no limit.
   */
  double torque_max_nm;
  /**
   * Largest change of tau, positive [N m/s]; INFINITY: no limit.
   */
  double torque_rate_max_nm_s;
  /**
   * Corrections of the estimates of e [1], of de [1/s], of phi/M [1/s^2] and of its derivatives per radian
   * that the joint is farther than expected: entry i in [1/s^i], order + 2 entries. From the third on they
   * are negative.
   */
  double correction[PHIHAT_CORRECTION_MAX];
  /**
   * The same per rad/s of the measured velocity, entry i in [1/s^(i-1)]; all zero: this law uses a velocity only
   * where it starts or takes over. A number has to be there always, and phihat_supervisor judges it.
   */
  double velocity_correction[PHIHAT_CORRECTION_MAX];
  /**
   * Share of the way to the wanted torque that is gone in one sample, above 0, at most 1 [1].
   */
  double share;
  /**
   * Transport delay from a sample to its torque, 0 ... PHIHAT_DELAY_MAX [samples].
   */
  uint64_t delay_samples;
  /**
   * Sections of the filter on the innovation nu, 0 ... PHIHAT_SECTIONS_MAX; 0: no filter.
   */
  uint64_t sections;
  /**
   * c_0, c_1 of each section, per sample [1]: its poles are z = 1 + w with w^2 + c_1 w + c_0 = 0, inside of the
   * circle where 0 < c_0 < c_1 and 2 c_1 < 4 + c_0.
   */
  double section_rates[PHIHAT_SECTIONS_MAX][2];
  /**
   * b_0, b_1 of each section: weights of its x and its y in the wanted torque, per M [1/s^2].
   */
  double section_weights_per_s2[PHIHAT_SECTIONS_MAX][2];
  /**
   * Cut-off f of a first-order low-pass on tau before the limits, of every form [Hz]; 0: none. With
   * s = 1 - exp(-2 pi f T), tau = r + s (tau - r), r the last torque as the limits let it through.
   */
  double torque_filter_hz;
} phihat_joint;

/**
 * Description of an error, for people and programs.
 */
typedef struct phihat_error {
  /**
   * sizeof(phihat_error).
   */
  size_t size;
  /**
   * Joint of the error, from 0; SIZE_MAX where none is meant.
   */
  size_t joint;
  /**
   * The value that was refused; NAN where none is meant.
   */
  double value;
  /**
   * Name of the member that was refused; empty where none is meant.
   */
  char member[32];
  /**
   * One line: what is wrong and what would be right.
   */
  char text[192];
} phihat_error;

/**
 * Measurements and references of all joints at a sample.
 */
typedef struct phihat_sample {
  /**
   * sizeof(phihat_sample).
   */
  size_t size;
  /**
   * Number of entries in each array: that of the controller's joints.
   */
  size_t joints;
  /**
   * Measured position [rad].
   */
  const double *q;
  /**
   * Measured velocity [rad/s].
   */
  const double *dq;
  /**
   * Torque that acted (mean) since the previous sample [N m]: after limits, delay and drive. Where it
   * is not measured: the torque that was commanded for that time.
   */
  const double *tau_applied;
  /**
   * Desired position [rad].
   */
  const double *q_des;
  /**
   * Desired velocity [rad/s].
   */
  const double *dq_des;
  /**
   * Desired acceleration [rad/s^2]. Of joints with PHIHAT_FORM_POSITIONS: its mean over the interval in which
   * the torque of this sample acts, from delay_samples periods after this sample to one period later. That is the
   * desired velocity at its end less that at its begin, over the period; q_des and dq_des are those of now.
   */
  const double *ddq_des;
} phihat_sample;

/**
 * Arrays for the commands of all joints.
 */
typedef struct phihat_command {
  /**
   * sizeof(phihat_command).
   */
  size_t size;
  /**
   * Number of entries in each array: that of the controller's joints.
   */
  size_t joints;
  /**
   * Torque to apply until the next sample [N m]: always finite and within the limits.
   */
  double *tau;
  /**
   * Estimate of the unknown dynamics [N m], contained in tau; may be null.
   */
  double *phi_hat;
  /**
   * PHIHAT_SATURATED, PHIHAT_RATE_LIMITED, PHIHAT_REFUSED; may be null.
   */
  uint32_t *flags;
} phihat_command;

/**
 * Limits and monitors of one joint; phihat_guard_default() fills it with "nothing is judged".
 */
typedef struct phihat_guard {
  /**
   * sizeof(phihat_guard).
   */
  size_t size;
  /**
   * Largest speed [rad/s]: a joint that is faster is stopped, and a jump to a higher speed, or a step in
   * position beyond it, is refused. INFINITY: not judged.
   */
  double velocity_max_rad_s;
  /**
   * Hard limits of the position [rad], beyond which the arm stops; -INFINITY and INFINITY: none.
   */
  double position_min_rad;
  /**
   * See position_min_rad; both or neither.
   */
  double position_max_rad;
  /**
   * Width of the soft zone inside of each hard limit [rad]; used where there are limits.
   */
  double position_soft_rad;
  /**
   * Deceleration that the joint can always afford near a limit [rad/s^2]; used where there are limits.
   */
  double braking_rad_s2;
  /**
   * Largest |e| while the law runs [rad]; beyond it the arm stops. INFINITY: not judged.
   */
  double error_stop_rad;
  /**
   * A position that stands still while the joint should have moved this far is frozen [rad]. INFINITY:
   * not judged.
   */
  double frozen_travel_rad;
  /**
   * Limits that every reference is shaped to [rad/s, rad/s^2, rad/s^3]; all INFINITY: it is taken as it
   * is.
   */
  double reference_velocity_max_rad_s;
  /**
   * See reference_velocity_max_rad_s.
   */
  double reference_acceleration_max_rad_s2;
  /**
   * See reference_velocity_max_rad_s.
   */
  double reference_jerk_max_rad_s3;
  /**
   * Inside this |e|, with the reference at rest, the estimate is held [rad]; 0: never.
   */
  double dead_zone_rad;
  /**
   * Root mean square of the torque's second difference that counts as oscillation [N m]. INFINITY: not
   * judged.
   */
  double oscillation_nm;
  /**
   * Torque variation that is enough to judge, at first motion, whether the joint goes the way the torque
   * pushes [N m, root mean square]. INFINITY: not judged.
   */
  double first_motion_nm;
  /**
   * Certified bound on the measured |e| in holding and tracking [rad]: the bound on |e|, and half a quantum of the
   * encoder. An error beyond it in three samples in a row stops the arm. INFINITY, or 0: not compared.
   */
  double error_bound_rad;
  /**
   * Ends of the box that every reference is kept in [rad], with the three limits of the reference; equal, or
   * infinite: none. An arm that is not inside is not engaged.
   */
  double reference_min_rad;
  /**
   * See reference_min_rad.
   */
  double reference_max_rad;
} phihat_guard;

/**
 * Options of a supervised arm; phihat_supervision_default() fills it.
 */
typedef struct phihat_supervision {
  /**
   * sizeof(phihat_supervision).
   */
  size_t size;
  /**
   * Time between samples [ns].
   */
  uint64_t period_ns;
  /**
   * Oldest usable sample [ns].
   */
  uint64_t age_max_ns;
  /**
   * Largest advance of the sequence number.
   */
  uint64_t sequence_window;
  /**
   * Samples missed in a row for which the last torque is held; then it fades to phi_hat.
   */
  uint32_t hold_samples;
  /**
   * Samples missed in a row that stop the arm.
   */
  uint32_t stop_samples;
  /**
   * Unbelievable samples in a row that stop the arm.
   */
  uint32_t bad_samples;
  /**
   * Samples missed of the last 64 that stop the arm.
   */
  uint32_t lost_max;
  /**
   * Largest speed that counts as rest [rad/s].
   */
  double rest_velocity_rad_s;
  /**
   * Largest distance between pose and reference at which tracking starts [rad].
   */
  double start_mismatch_max_rad;
  /**
   * Blend time of a change of reference [s].
   */
  double blend_s;
  /**
   * Damping while armed and in a stop, as a share of K_d, 0 to 1.
   */
  double stop_damping;
  /**
   * Time in a stop after which the brakes are requested even if the arm still moves [s].
   */
  double stop_s;
  /**
   * Longest time of a torque at its limit without a break before the arm is stopped [s]; INFINITY, or 0:
   * no bound.
   */
  double saturation_s;
  /**
   * Time from the request for the brakes until they hold the arm [s]; the law gives way then. INFINITY, or
   * 0: there are no brakes, and the law holds a stopped arm for as long as it is measured.
   */
  double brake_closing_s;
} phihat_supervision;

/**
 * Number and time of a sample, and the request of the caller.
 */
typedef struct phihat_request {
  /**
   * sizeof(phihat_request).
   */
  size_t size;
  /**
   * Number of the sample, counted by the robot; repeat the last one when none came.
   */
  uint64_t sequence;
  /**
   * When the sample was taken, by any clock that goes forward [ns].
   */
  uint64_t t_ns;
  /**
   * Now, by the same clock [ns].
   */
  uint64_t now_ns;
  /**
   * Torques that hold the arm [N m], used when it is armed; null: those of the last stop, or zero.
   */
  const double *preset;
  /**
   * PHIHAT_REQUEST_IDLE, _ARM, _HOLD, _TRACK or _STOP: a level, repeated at every sample.
   */
  uint32_t mode;
  /**
   * Feed-forward torque along the reference in force, in addition to inertia times ddq_des [N m], one
   * entry per joint, as the gravity of a description; null: none. A law from positions estimates the rest,
   * and the feed-forward begins and ends without a step in torque; the other forms do not use it. One that
   * is not finite is refused, and the last one held. phi_hat of the command is the sum of the estimate and
   * this.
   */
  const double *feed_forward;
} phihat_request;

/**
 * Report on a sample.
 */
typedef struct phihat_report {
  /**
   * sizeof(phihat_report).
   */
  size_t size;
  /**
   * Joint of the fault, from 0; SIZE_MAX without a fault.
   */
  size_t fault_joint;
  /**
   * Fault that stopped the arm, stored until the arm is armed again, as in "link-lost"; null without a
   * fault.
   */
  const char *fault;
  /**
   * Why the request was not granted, as in "not-at-rest"; null if it was.
   */
  const char *refusal;
  /**
   * PHIHAT_MODE_IDLE, _ARMED, _HOLDING, _TRACKING or _SAFE_STOP, from this sample on.
   */
  uint32_t mode;
  /**
   * Set of events; phihat_event_text() names each bit.
   */
  uint32_t events;
  /**
   * 1: the brakes should be closed.
   */
  uint32_t brake;
  /**
   * Samples missed in a row.
   */
  uint32_t misses;
  /**
   * Samples missed of the last 64.
   */
  uint32_t lost;
} phihat_report;

/**
 * Limits of a phihat_gate.
 */
typedef struct phihat_gate_limits {
  /**
   * sizeof(phihat_gate_limits).
   */
  size_t size;
  /**
   * Number of joints, at least 1.
   */
  size_t joints;
  /**
   * Largest |tau|, positive, one per joint [N m]; INFINITY: no limit.
   */
  const double *torque_max_nm;
  /**
   * Largest change of tau per time, positive, one per joint [N m/s]; INFINITY: no limit.
   */
  const double *torque_rate_max_nm_s;
  /**
   * The most energy that all drives together may give the arm within energy_window_s, positive [J];
   * INFINITY: no limit.
   */
  double energy_max_j;
  /**
   * The time that energy_max_j is counted in, positive [s]; not looked at without one.
   */
  double energy_window_s;
  /**
   * Time between samples, positive [s].
   */
  double period_s;
} phihat_gate_limits;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * One line about a status, in English; never null, never to be freed.
 */
const char *phihat_status_text(int32_t status);

/**
 * Version of this library, as in "1.2.3"; never null, never to be freed.
 */
const char *phihat_version(void);

/**
 * Makes a controller, at rest and with zero knowledge of the arm. Allocates; not for the control loop.
 *
 * @param joints     Gains and limits, one per joint.
 * @param count      Number of joints, at least 1.
 * @param period_s   Time between samples, positive [s].
 * @param controller Receives the handle; free it with phihat_controller_destroy().
 * @param error      Receives what was wrong; set its size first. May be null.
 *
 * # Safety
 *
 * Every pointer is null or valid for what the header says of it.
 */
enum phihat_status phihat_controller_create(const struct phihat_joint *joints,
                                            size_t count,
                                            double period_s,
                                            struct phihat_controller **controller,
                                            struct phihat_error *error);

/**
 * Frees a controller; null is allowed. The handle is gone afterwards.
 *
 * # Safety
 *
 * `controller` is null or came from phihat_controller_create() and was not freed before.
 */
void phihat_controller_destroy(struct phihat_controller *controller);

/**
 * Number of joints; 0 for a null handle.
 *
 * # Safety
 *
 * `controller` is null or a living handle.
 */
size_t phihat_controller_joints(const struct phihat_controller *controller);

/**
 * Back to rest and zero knowledge, as after phihat_controller_create().
 *
 * # Safety
 *
 * `controller` is null or a living handle.
 */
enum phihat_status phihat_controller_reset(struct phihat_controller *controller);

/**
 * Answers one sample of the whole arm; call it once per period. Real time. PHIHAT_STATUS_REFUSED: the
 * sample was not finite, or beyond +-2^32 (4.3e9), or led to what is not finite; every joint holds its last
 * torque, which is in `command`, and no joint remembers the sample. The arrays of sample and command may
 * overlap.
 *
 * # Safety
 *
 * Every pointer is null or valid for what the header says of it.
 */
enum phihat_status phihat_controller_update(struct phihat_controller *controller,
                                            const struct phihat_sample *sample,
                                            const struct phihat_command *command);

/**
 * Takes over a moving or loaded arm without a bump: the torque that the next phihat_controller_update()
 * commands continues `tau`, the torque that acts now [N m]; beyond a joint's largest torque it counts as
 * that. If the sample or tau is not finite, or beyond +-2^32 (4.3e9), nothing changes and the answer is
 * PHIHAT_STATUS_REFUSED.
 *
 * # Safety
 *
 * Every pointer is null or valid for what the header says of it.
 */
enum phihat_status phihat_controller_resume(struct phihat_controller *controller,
                                            const struct phihat_sample *sample,
                                            const double *tau);

/**
 * Fills a phihat_guard with "nothing is judged"; set its size first.
 *
 * # Safety
 *
 * `guard` is null or points to a phihat_guard whose size is set.
 */
enum phihat_status phihat_guard_default(struct phihat_guard *guard);

/**
 * Fills a phihat_supervision with the defaults at a period [ns]; set its size first.
 *
 * # Safety
 *
 * `supervision` is null or points to a phihat_supervision whose size is set.
 */
enum phihat_status phihat_supervision_default(uint64_t period_ns,
                                              struct phihat_supervision *supervision);

/**
 * Makes a supervised controller, idle. Allocates; not for the control loop.
 *
 * @param joints      Gains and limits, one per joint.
 * @param guards      Limits and monitors, one per joint; null: as phihat_guard_default() sets them.
 * @param count       Number of joints, at least 1.
 * @param supervision Options of the supervised arm.
 * @param supervisor  Receives the handle; free it with phihat_supervisor_destroy().
 * @param error       Receives what was wrong; set its size first. May be null.
 *
 * # Safety
 *
 * Every pointer is null or valid for what the header says of it.
 */
enum phihat_status phihat_supervisor_create(const struct phihat_joint *joints,
                                            const struct phihat_guard *guards,
                                            size_t count,
                                            const struct phihat_supervision *supervision,
                                            struct phihat_supervisor **supervisor,
                                            struct phihat_error *error);

/**
 * Frees a supervised controller; null is allowed. The handle is gone afterwards.
 *
 * # Safety
 *
 * `supervisor` is null or came from phihat_supervisor_create() and was not freed before.
 */
void phihat_supervisor_destroy(struct phihat_supervisor *supervisor);

/**
 * Answers one period of the whole arm; call it once per period, whether a new sample came or not. Real time.
 * Whatever the values, the torques are finite and within their limits, and what happened is in `report`.
 * The arrays of sample and command may overlap.
 *
 * # Safety
 *
 * Every pointer is null or valid for what the header says of it.
 */
enum phihat_status phihat_supervisor_step(struct phihat_supervisor *supervisor,
                                          const struct phihat_sample *sample,
                                          const struct phihat_request *request,
                                          const struct phihat_command *command,
                                          struct phihat_report *report);

/**
 * Name of an event, of which `bit` is the place, from 0; null where there is none.
 */
const char *phihat_event_text(uint32_t bit);

/**
 * Makes a gate, behind drives that give no torque yet. Allocates; not for the control loop.
 *
 * A gate is the last thing before a torque leaves: behind gravity compensation, feed-forward and all else
 * that computes on it.
 *
 * @param limits Limits of the gate.
 * @param gate   Receives the handle; free it with phihat_gate_destroy().
 * @param error  Receives what was wrong; set its size first. May be null.
 *
 * # Safety
 *
 * Every pointer is null or valid for what the header says of it.
 */
enum phihat_status phihat_gate_create(const struct phihat_gate_limits *limits,
                                      struct phihat_gate **gate,
                                      struct phihat_error *error);

/**
 * Frees a gate; null is allowed. The handle is gone afterwards.
 *
 * # Safety
 *
 * `gate` is null or came from phihat_gate_create() and was not freed before.
 */
void phihat_gate_destroy(struct phihat_gate *gate);

/**
 * From here on the rate counts from `tau`, the torques with which something else holds the arm, one per
 * joint [N m]. A value that is not finite changes nothing.
 *
 * # Safety
 *
 * Every pointer is null or valid for what the header says of it.
 */
enum phihat_status phihat_gate_hold(struct phihat_gate *gate,
                                    const double *tau);

/**
 * Lets the torques of a sample out; call it once per period, and send what it leaves in `command`, whatever
 * it answers. Real time.
 *
 * `command->tau` holds the requested torques, and then those that may be sent: finite, within range and
 * rate, and, where an energy is limited, scaled down along the motion. A torque that is not finite becomes
 * the last one, and its joint has the flag PHIHAT_REFUSED.
 *
 * @param gate    The handle.
 * @param q       Measured position, one per joint [rad]; what is not finite counts as the last one.
 * @param command Torques in and out; phi_hat is not looked at, flags may be null.
 *
 * # Safety
 *
 * Every pointer is null or valid for what the header says of it.
 */
enum phihat_status phihat_gate_release(struct phihat_gate *gate,
                                       const double *q,
                                       const struct phihat_command *command);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* PHIHAT_H */
