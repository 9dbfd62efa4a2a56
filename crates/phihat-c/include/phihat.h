/**
 * @file phihat.h
 * The phihat controller: robust-adaptive joint torque control. C99 and C++17; made by cbindgen from
 * crates/phihat-c, do not edit.
 *
 *     tau = M (ddq_des - K_d de - K_p e) + phi_hat,      e = q - q_des (measured minus desired)
 *
 * SI units and radians; for prismatic joints read m for rad and N for N m. Arrays have one entry per
 * joint, in the order of the joints given to phihat_controller_create().
 *
 * Every structure begins with its own size, set by the caller (`.size = sizeof(phihat_joint)`), so that
 * later versions can add members at the end. Every function answers a phihat_status.
 *
 * Real time: phihat_controller_create() allocates, phihat_controller_destroy() frees, nothing else
 * touches the heap, waits, or calls the system. Different controllers may be used by different threads;
 * one controller by one thread at a time.
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
 * Form of the law: a disturbance observer fed with the torque that acted. The default.
 */
#define PHIHAT_FORM_OBSERVER 0

/**
 * Form of the law: the paper's integrals of the error, for reproduction; winds up under saturation.
 */
#define PHIHAT_FORM_LITERAL 1

/**
 * Flag of a command: the torque limit acted.
 */
#define PHIHAT_SATURATED 1

/**
 * Flag of a command: the torque-rate limit acted.
 */
#define PHIHAT_RATE_LIMITED 2

/**
 * Flag of a command: the sample was not finite; the last torque is held, the state untouched.
 */
#define PHIHAT_REFUSED 4

/**
 * What a call came to.
 */
typedef enum phihat_status {
  /**
   * Done.
   */
  PHIHAT_STATUS_OK = 0,
  /**
   * The sample held something that is not finite: the command holds the last torque of every joint,
   * the controller's state is untouched.
   */
  PHIHAT_STATUS_REFUSED = 1,
  /**
   * A pointer that must not be null is.
   */
  PHIHAT_STATUS_NULL_POINTER = 2,
  /**
   * A structure's `size` is not sizeof() of it: another version of the header.
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
} phihat_status;

/**
 * A controller for an arm: gains, what they remember, and room for one sample.
 */
typedef struct phihat_controller phihat_controller;

/**
 * Gains and limits of one joint.
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
   * Estimator coefficients a_0 ... a_(order-1), positive; a_i in [1/s^(order-i)].
   */
  double a[PHIHAT_ORDER_MAX];
  /**
   * Order of the estimator, 1 ... PHIHAT_ORDER_MAX.
   */
  uint32_t order;
  /**
   * PHIHAT_FORM_OBSERVER or PHIHAT_FORM_LITERAL.
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
} phihat_joint;

/**
 * What was wrong, for people and programs.
 */
typedef struct phihat_error {
  /**
   * sizeof(phihat_error).
   */
  size_t size;
  /**
   * Which joint, from 0; SIZE_MAX where none is meant.
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
 * What the sensors say at a sample, and what the arm shall do.
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
   * Desired acceleration [rad/s^2].
   */
  const double *ddq_des;
} phihat_sample;

/**
 * Where the answer goes.
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
 * sample was not finite, and every joint holds its last torque; that torque is in `command`. The arrays
 * of sample and command may overlap.
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
 * commands continues `tau`, the torque that acts now [N m]. Where the sample or tau is not finite, nothing
 * changes and the answer is PHIHAT_STATUS_REFUSED.
 *
 * # Safety
 *
 * Every pointer is null or valid for what the header says of it.
 */
enum phihat_status phihat_controller_resume(struct phihat_controller *controller,
                                            const struct phihat_sample *sample,
                                            const double *tau);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* PHIHAT_H */
