/* 02: a joint under supervision: armed, held, tracked; then the link to the robot is lost, and comes back.
 *
 * The pendulum of 01_controller.c. The supervisor judges every sample, starts without a jolt, holds the torque
 * while samples are missing, stops when too many are, and starts again when it is asked to.
 */
#include "phihat.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define PERIOD_NS 1000000u

typedef struct pendulum {
  double q, dq, tau;
} pendulum;

/* One millisecond of 2 kg on 0.4 m, with dry friction and a brake. */
static void move(pendulum *p, double tau, int brake) {
  const double mass = 2.0, length = 0.4, inertia = mass * length * length, T = 1e-9 * PERIOD_NS;
  double friction = 0.5 * p->dq / sqrt(p->dq * p->dq + 1e-4);
  p->tau = tau;
  p->dq += T * (tau - friction - mass * 9.81 * length * sin(p->q)) / inertia;
  if (brake) p->dq = 0.0;
  p->q += T * p->dq;
}

static const char *const modes[] = {"idle", "armed", "holding", "tracking", "safe stop"};

int main(void) {
  const double q_start = 0.4;
  pendulum arm;
  phihat_joint joint;
  phihat_guard guard;
  phihat_supervision supervision;
  phihat_error error;
  phihat_supervisor *supervisor = NULL;
  phihat_report report;
  unsigned long long k, seen = 0;
  unsigned was = PHIHAT_MODE_IDLE, stops = 0, starts = 0;
  int brake = 1;
  double worst = 0.0;

  memset(&joint, 0, sizeof joint);
  joint.size = sizeof joint;
  joint.inertia_kg_m2 = 0.25;
  joint.kp_per_s2 = 400.0;
  joint.kd_per_s = 40.0;
  joint.order = 2;
  joint.a[0] = 4900.0;
  joint.a[1] = 140.0;
  joint.form = PHIHAT_FORM_OBSERVER;
  joint.torque_max_nm = 40.0;
  joint.torque_rate_max_nm_s = 1000.0;

  guard.size = sizeof guard;
  phihat_guard_default(&guard);
  guard.velocity_max_rad_s = 4.0;
  guard.position_min_rad = -1.5;
  guard.position_max_rad = 1.5;
  guard.error_stop_rad = 0.1;

  supervision.size = sizeof supervision;
  phihat_supervision_default(PERIOD_NS, &supervision);

  error.size = sizeof error;
  if (phihat_supervisor_create(&joint, &guard, 1, &supervision, &supervisor, &error) != PHIHAT_STATUS_OK) {
    fprintf(stderr, "%s\n", error.text);
    return 2;
  }

  arm.q = q_start;
  arm.dq = arm.tau = 0.0;
  for (k = 0; k < 12000; ++k) {
    const double t = 1e-3 * (double)k, w = 2.0 * 3.141592653589793 * 0.3;
    const double q_des = q_start + 0.3 * sin(w * t) * sin(w * t);
    const double dq_des = 0.3 * w * sin(2.0 * w * t), ddq_des = 0.6 * w * w * cos(2.0 * w * t);
    const int link_lost = k >= 6000 && k < 6500;
    double tau = 0.0;
    phihat_sample sample;
    phihat_request request;
    phihat_command command;

    if (!link_lost) seen = k;
    sample.size = sizeof sample;
    sample.joints = 1;
    sample.q = &arm.q;
    sample.dq = &arm.dq;
    sample.tau_applied = &arm.tau;
    sample.q_des = &q_des;
    sample.dq_des = &dq_des;
    sample.ddq_des = &ddq_des;
    request.size = sizeof request;
    request.sequence = seen;
    request.t_ns = seen * PERIOD_NS;
    request.now_ns = k * PERIOD_NS;
    request.preset = NULL;
    request.feed_forward = NULL;
    /* What a person would ask for: arm, hold, track; after the stop, once the link is back, the same again. */
    request.mode = PHIHAT_REQUEST_TRACK;
    if (k < 1000) request.mode = PHIHAT_REQUEST_HOLD;
    if (k < 10) request.mode = PHIHAT_REQUEST_ARM;
    if (k >= 6100 && k < 7000) request.mode = PHIHAT_REQUEST_STOP;
    if (k >= 7000 && k < 7010) request.mode = PHIHAT_REQUEST_ARM;
    if (k >= 7010 && k < 8333) request.mode = PHIHAT_REQUEST_HOLD;
    command.size = sizeof command;
    command.joints = 1;
    command.tau = &tau;
    command.phi_hat = NULL;
    command.flags = NULL;
    report.size = sizeof report;
    if (phihat_supervisor_step(supervisor, &sample, &request, &command, &report) != PHIHAT_STATUS_OK) return 1;

    if (report.mode != was) {
      printf("%6.3f s  %s%s%s\n", t, modes[report.mode], report.fault ? ": " : "", report.fault ? report.fault : "");
      stops += report.mode == PHIHAT_MODE_SAFE_STOP;
      starts += report.mode == PHIHAT_MODE_TRACKING;
      was = report.mode;
    }
    if (!isfinite(tau) || fabs(tau) > 40.0) return 1;
    if (report.mode == PHIHAT_MODE_TRACKING && (k > 10000 || (k > 2500 && k < 6000)))
      worst = fmax(worst, fabs(arm.q - q_des));
    brake = report.brake != 0;
    move(&arm, tau, brake);
  }
  phihat_supervisor_destroy(supervisor);
  printf("%u starts, %u stop; largest error while tracking: %.2f mrad\n", starts, stops, 1e3 * worst);
  return starts == 2 && stops == 1 && worst < 5e-3 ? 0 : 1;
}
