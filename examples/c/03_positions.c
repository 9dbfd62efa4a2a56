/* 03: the law from positions: an encoder, no velocity, one sample of delay.
 *
 * The pendulum of 01_controller.c. Every torque acts one millisecond late, and the joint tells its angle alone, in
 * steps of 0.024 mrad. The law predicts across the delay, and asks to know what the motion needs in the interval
 * in which its torque acts.
 */
#include "phihat.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define DELAY 1

static const double pi = 3.141592653589793, T = 1e-3;

/* A motion that starts at rest, and its velocity. */
static double q_wanted(double t) { return 0.5 * pow(sin(0.6 * pi * t), 2); }
static double dq_wanted(double t) { return 0.3 * pi * sin(1.2 * pi * t); }

int main(void) {
  const double mass = 2.0, length = 0.4, inertia = mass * length * length, step = 2.0 * pi / 262144.0;
  double q = 0.0, dq = 0.0, acting = 0.0, coming = 0.0, worst = 0.0;
  long k;

  /* All three poles of the observer at r, per sample. */
  const double r = 0.85;
  phihat_joint joint;
  phihat_error error;
  phihat_controller *controller = NULL;
  memset(&joint, 0, sizeof joint); /* no velocity_correction: the velocity is not used */
  joint.size = sizeof joint;
  joint.form = PHIHAT_FORM_POSITIONS;
  joint.inertia_kg_m2 = 0.25; /* a guess: the true one is 0.32 */
  joint.kp_per_s2 = 20.0 * 20.0;
  joint.kd_per_s = 2.0 * 20.0;
  joint.order = 1;
  joint.correction[0] = 1.0 - r * r * r;
  joint.correction[1] = 1.5 * (1.0 - r * r) * (1.0 - r) / T;
  joint.correction[2] = -pow((1.0 - r) / T, 2) * (1.0 - r);
  joint.share = 0.5;
  joint.delay_samples = DELAY;
  joint.torque_max_nm = 40.0;
  joint.torque_rate_max_nm_s = INFINITY;
  error.size = sizeof error;
  if (phihat_controller_create(&joint, 1, T, &controller, &error) != PHIHAT_STATUS_OK) {
    fprintf(stderr, "%s: %s\n", error.member, error.text);
    return 2;
  }

  for (k = 0; k < 10000; ++k) {
    const double t = (double)k * T, from = t + DELAY * T, to = from + T;
    const double encoder = step * floor(q / step + 0.5), unknown = 0.0;
    const double q_des = q_wanted(t), dq_des = dq_wanted(t);
    /* The mean acceleration of the interval in which this torque acts. */
    const double ddq_des = (dq_wanted(to) - dq_wanted(from)) / T;
    double tau = 0.0, friction, ddq;
    phihat_sample sample;
    phihat_command command;
    sample.size = sizeof sample;
    sample.joints = 1;
    sample.q = &encoder;
    sample.dq = &unknown;
    sample.tau_applied = &acting;
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

    /* The pendulum, which the controller does not know, under the torque of the sample before. */
    acting = coming;
    coming = tau;
    friction = 0.5 * dq / sqrt(dq * dq + 1e-4);
    ddq = (acting - friction - mass * 9.81 * length * sin(q)) / inertia;
    q += T * (dq + 0.5 * T * ddq);
    dq += T * ddq;
  }
  phihat_controller_destroy(controller);
  printf("largest error after 1 s: %.2f mrad\n", 1e3 * worst);
  return worst < 3e-3 ? 0 : 1;
}
