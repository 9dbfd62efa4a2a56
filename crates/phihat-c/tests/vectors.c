/* Replays crates/phihat/tests/vectors/controller.txt: every answer must have the same bits. */
#include "phihat.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define JOINTS_MAX 16
#define LINE_MAX_ 65536

static char line[LINE_MAX_];
static unsigned number = 0;

static void fail(const char *what) {
  fprintf(stderr, "vectors: line %u: %s\n", number, what);
  exit(1);
}

/* The next `count` numbers of the line. */
static void numbers(char **at, double *to, size_t count) {
  size_t i;
  for (i = 0; i < count; ++i) {
    char *end;
    to[i] = strtod(*at, &end);
    if (end == *at) fail("a number is missing");
    *at = end;
  }
}

static double number_(char **at) {
  double value;
  numbers(at, &value, 1);
  return value;
}

static uint32_t form(const char *word) {
  if (!strncmp(word, "observer ", 9)) return PHIHAT_FORM_OBSERVER;
  if (!strncmp(word, "literal ", 8)) return PHIHAT_FORM_LITERAL;
  if (!strncmp(word, "positions ", 10)) return PHIHAT_FORM_POSITIONS;
  if (!strncmp(word, "filtered ", 9)) return PHIHAT_FORM_POSITIONS;
  fail("form");
  return 0;
}

static int same(double a, double b) { return memcmp(&a, &b, sizeof a) == 0; }

int main(int argc, char **argv) {
  FILE *file = argc == 2 ? fopen(argv[1], "r") : NULL;
  phihat_controller *controller = NULL;
  phihat_joint joints[JOINTS_MAX];
  double in[6][JOINTS_MAX], tau[JOINTS_MAX], phi_hat[JOINTS_MAX], want[JOINTS_MAX];
  uint32_t flags[JOINTS_MAX];
  double period = 0.0;
  size_t n = 0, have = 0, i;
  unsigned answers = 0, refused = 0, cases = 0, seeing = 0, sections = 0;
  phihat_sample sample;
  phihat_command command;

  if (!file) return fprintf(stderr, "usage: vectors FILE\n"), 2;
  while (fgets(line, LINE_MAX_, file)) {
    char *at = strchr(line, ' ');
    ++number;
    if (line[0] == '#') continue;
    if (!at) fail("no verb");
    if (!strncmp(line, "case ", 5)) {
      at = strchr(at + 1, ' '); /* skips the name */
      if (!at) fail("no joints");
      n = (size_t)number_(&at);
      period = number_(&at);
      if (n == 0 || n > JOINTS_MAX) fail("joints");
      have = 0;
      ++cases;
    } else if (!strncmp(line, "joint ", 6)) {
      phihat_joint *joint = &joints[have++];
      memset(joint, 0, sizeof *joint);
      joint->size = sizeof *joint;
      joint->form = form(line + 6);
      at = strchr(at + 1, ' ');
      if (!at) fail("no order");
      joint->order = (uint32_t)number_(&at);
      joint->inertia_kg_m2 = number_(&at);
      joint->kp_per_s2 = number_(&at);
      joint->kd_per_s = number_(&at);
      if (joint->form == PHIHAT_FORM_POSITIONS) {
        numbers(&at, joint->correction, joint->order + 2);
        numbers(&at, joint->velocity_correction, joint->order + 2);
        joint->share = number_(&at);
        joint->delay_samples = (uint64_t)number_(&at);
        if (line[6] == 'f') {
          joint->sections = (uint64_t)number_(&at);
          if (joint->sections > PHIHAT_SECTIONS_MAX) fail("sections");
          for (i = 0; i < joint->sections; ++i) {
            numbers(&at, joint->section_rates[i], 2);
            numbers(&at, joint->section_weights_per_s2[i], 2);
            ++sections;
          }
        }
        ++seeing;
      } else {
        numbers(&at, joint->a, joint->order);
      }
      joint->torque_max_nm = number_(&at);
      joint->torque_rate_max_nm_s = number_(&at);
      if (have == n) {
        phihat_error error;
        error.size = sizeof error;
        phihat_controller_destroy(controller);
        if (phihat_controller_create(joints, n, period, &controller, &error) != PHIHAT_STATUS_OK)
          fail(error.text);
        if (phihat_controller_joints(controller) != n) fail("number of joints");
      }
    } else if (!strncmp(line, "sample ", 7) || !strncmp(line, "resume ", 7)) {
      phihat_status status;
      for (i = 0; i < 6; ++i) numbers(&at, in[i], n);
      sample.size = sizeof sample;
      sample.joints = n;
      sample.q = in[0];
      sample.dq = in[1];
      sample.tau_applied = in[2];
      sample.q_des = in[3];
      sample.dq_des = in[4];
      sample.ddq_des = in[5];
      if (line[0] == 'r') {
        numbers(&at, tau, n);
        if (phihat_controller_resume(controller, &sample, tau) != PHIHAT_STATUS_OK) fail("resume");
        continue;
      }
      command.size = sizeof command;
      command.joints = n;
      command.tau = in[2]; /* arrays may overlap */
      command.phi_hat = phi_hat;
      command.flags = flags;
      status = phihat_controller_update(controller, &sample, &command);
      refused += status == PHIHAT_STATUS_REFUSED;
      if (status != PHIHAT_STATUS_OK && status != PHIHAT_STATUS_REFUSED)
        fail(phihat_status_text((int32_t)status));
    } else if (!strncmp(line, "answer ", 7)) {
      numbers(&at, want, n);
      for (i = 0; i < n; ++i) if (!same(want[i], in[2][i])) fail("tau differs");
      numbers(&at, want, n);
      for (i = 0; i < n; ++i) if (!same(want[i], phi_hat[i])) fail("phi_hat differs");
      numbers(&at, want, n);
      for (i = 0; i < n; ++i) if (want[i] != (double)flags[i]) fail("flags differ");
      ++answers;
    } else {
      fail("unknown verb");
    }
  }
  fclose(file);
  if (phihat_controller_reset(controller) != PHIHAT_STATUS_OK) fail("reset");
  phihat_controller_destroy(controller);
  phihat_controller_destroy(NULL);
  if (cases < 18 || answers < 720 || refused != cases || seeing < 30 || sections < 9) fail("too few vectors");
  printf("%u cases, %u answers: the same bits\n", cases, answers);
  return 0;
}
