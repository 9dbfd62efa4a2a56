/* 01: one joint under control, from C or C++.
 *
 * A pendulum of 2 kg on 0.4 m with dry friction. The controller knows neither mass, length, gravity nor
 * friction: one nominal inertia, a bandwidth, and the torque that acted.
 *
 *   cargo build --release -p phihat-c
 *   cc -std=c99 -Icrates/phihat-c/include examples/c/01_controller.c \
 *      -Ltarget/release -l:libphihat_c.a -lm -lpthread -ldl && ./a.out
 */
#include "phihat.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

int main(void) {
  const double pi = 3.141592653589793, T = 1e-3;
  const double mass = 2.0, length = 0.4, inertia = mass * length * length;
  double q = 0.0, dq = 0.0, tau = 0.0, worst = 0.0;
  long k;

  /* Bandwidth 20 rad/s, second-order estimator with both poles at 70 rad/s. */
  phihat_joint joint;
  phihat_error error;
  phihat_controller *controller = NULL;
  memset(&joint, 0, sizeof joint); /* what is not named here is off */
  joint.size = sizeof joint;
  joint.inertia_kg_m2 = 0.25; /* a guess: the true one is 0.32 */
  joint.kp_per_s2 = 20.0 * 20.0;
  joint.kd_per_s = 2.0 * 20.0;
  joint.order = 2;
  joint.a[0] = 70.0 * 70.0;
  joint.a[1] = 2.0 * 70.0;
  joint.a[2] = joint.a[3] = 0.0;
  joint.form = PHIHAT_FORM_OBSERVER;
  joint.torque_max_nm = 40.0;
  joint.torque_rate_max_nm_s = INFINITY;
  error.size = sizeof error;
  if (phihat_controller_create(&joint, 1, T, &controller, &error) != PHIHAT_STATUS_OK) {
    fprintf(stderr, "%s\n", error.text);
    return 2;
  }

  for (k = 0; k < 10000; ++k) {
    const double t = (double)k * T, w = 2.0 * pi * 0.3;
    const double q_des = 0.5 * sin(w * t) * sin(w * t); /* starts at rest */
    const double dq_des = 0.5 * w * sin(2.0 * w * t);
    const double ddq_des = w * w * cos(2.0 * w * t);
    double friction, ddq;
    phihat_sample sample;
    phihat_command command;
    sample.size = sizeof sample;
    sample.joints = 1;
    sample.q = &q;
    sample.dq = &dq;
    sample.tau_applied = &tau;
    sample.q_des = &q_des;
    sample.dq_des = &dq_des;
    sample.ddq_des = &ddq_des;
    command.size = sizeof command;
    command.joints = 1;
    command.tau = &tau;
    command.phi_hat = NULL;
    command.flags = NULL;
    if (phihat_controller_update(controller, &sample, &command) != PHIHAT_STATUS_OK) return 1;

    if (t > 1.0 && fabs(q - q_des) > worst) worst = fabs(q - q_des);

    /* The pendulum, which the controller does not know. */
    friction = 0.5 * dq / sqrt(dq * dq + 1e-4);
    ddq = (tau - friction - mass * 9.81 * length * sin(q)) / inertia;
    dq += T * ddq;
    q += T * dq;
  }
  phihat_controller_destroy(controller);
  printf("phihat %s: largest error after 1 s: %.2f mrad\n", phihat_version(), 1e3 * worst);
  return worst < 5e-3 ? 0 : 1;
}
