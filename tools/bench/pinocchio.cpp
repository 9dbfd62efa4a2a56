// Times Pinocchio's algorithms, header-only, on the arms of a file that export_arms.py wrote.
//
//   pinocchio ARMS [blocks]
//
// One JSON object per line on standard output: {"robot":"panda","algorithm":"aba","ns":887.0}, and
// {"robot":"panda","algorithm":"closed_loop_rk4","times_real_time":250.0}.
//
// Method: blocks of about 0.4 ms of calls, cycling over 64 random states, between two readings of
// CLOCK_MONOTONIC_RAW; the median over the blocks (301 unless told). Where Pinocchio has
// two conventions for an algorithm, both are timed and the faster one is printed.

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/multibody.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <random>
#include <stdexcept>
#include <string>
#include <time.h>
#include <vector>

namespace pin = pinocchio;
using Vector = Eigen::VectorXd;

struct State {
  Vector q, qd, qdd, tau;
};

struct Arm {
  std::string name;
  pin::Model model;
  State check;  // `tau` is the oracle's
};

static double seconds() {
  timespec t;
  clock_gettime(CLOCK_MONOTONIC_RAW, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

// The compiler must assume that everything in memory was read and written here.
static void fence() { asm volatile("" ::: "memory"); }

static double number(std::istream& in) {
  double value;
  if (!(in >> value)) throw std::runtime_error("a number is missing in the arms file");
  return value;
}

static Vector vector(std::istream& in, int n) {
  Vector v(n);
  for (int i = 0; i < n; ++i) v[i] = number(in);
  return v;
}

static pin::JointModel joint(const std::string& type) {
  if (type == "JointModelRX") return pin::JointModelRX();
  if (type == "JointModelRY") return pin::JointModelRY();
  if (type == "JointModelRZ") return pin::JointModelRZ();
  throw std::runtime_error("no such joint here: " + type);
}

static void read_body(std::istream& in, pin::Model& model) {
  std::string word, type;
  pin::JointIndex parent;
  in >> word >> type >> parent;
  const Eigen::Vector3d position = vector(in, 3);
  Eigen::Matrix3d rotation;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) rotation(r, c) = number(in);
  const double mass = number(in);
  const Eigen::Vector3d com = vector(in, 3);
  const Eigen::Matrix<double, 6, 1> inertia = vector(in, 6);
  const auto id = model.addJoint(parent, joint(type), pin::SE3(rotation, position),
                                 "joint" + std::to_string(model.njoints));
  model.appendBodyToJoint(id, pin::Inertia(mass, com, pin::Symmetric3(inertia)), pin::SE3::Identity());
}

static std::vector<Arm> read_arms(const char* path) {
  std::ifstream in(path);
  std::vector<Arm> arms;
  std::string word;
  while (in >> word) {
    Arm arm;
    int n;
    in >> arm.name >> n;
    for (int i = 0; i < n; ++i) read_body(in, arm.model);
    in >> word;
    arm.check.q = vector(in, n);
    arm.check.qd = vector(in, n);
    arm.check.qdd = vector(in, n);
    arm.check.tau = vector(in, n);
    arms.push_back(arm);
  }
  return arms;
}

static std::vector<State> random_states(int n) {
  std::mt19937_64 random(20261121);
  auto draw = [&](double bound) {
    std::uniform_real_distribution<double> uniform(-bound, bound);
    Vector v(n);
    for (int i = 0; i < n; ++i) v[i] = uniform(random);
    return v;
  };
  std::vector<State> states(64);
  for (State& s : states) s = {draw(3.0), draw(2.0), draw(5.0), draw(20.0)};
  return states;
}

// The model must be the arm, and its algorithms each other's inverse, before their speed means anything.
static void check(const Arm& arm, const std::vector<State>& states) {
  pin::Data data(arm.model);
  const State& s = arm.check;
  const double rnea_error =
      (pin::rnea(arm.model, data, s.q, s.qd, s.qdd) - s.tau).cwiseAbs().maxCoeff() /
      s.tau.cwiseAbs().maxCoeff();
  double aba_error = 0.0;
  for (const State& x : states) {
    const Vector tau = pin::rnea(arm.model, data, x.q, x.qd, x.qdd);
    for (auto convention : {pin::Convention::LOCAL, pin::Convention::WORLD}) {
      const Vector back = pin::aba(arm.model, data, x.q, x.qd, tau, convention);
      aba_error = std::max(aba_error, (back - x.qdd).cwiseAbs().maxCoeff());
    }
  }
  if (!(rnea_error < 1e-12) || !(aba_error < 1e-10)) {
    std::fprintf(stderr, "%s: RNEA is off the oracle by %g (relative), ABA of RNEA by %g rad/s^2\n",
                 arm.name.c_str(), rnea_error, aba_error);
    std::exit(1);
  }
}

template <class Call>
static double median_ns(int blocks, const std::vector<State>& states, Call call) {
  auto run = [&](long calls) {
    const double start = seconds();
    for (long k = 0; k < calls; ++k) {
      call(states[k % 64]);
      fence();
    }
    return seconds() - start;
  };
  long calls = 64;
  while (run(calls) < 0.4e-3) calls += calls / 4;
  std::vector<double> times(blocks);
  for (double& t : times) t = run(calls) / double(calls);
  std::nth_element(times.begin(), times.begin() + blocks / 2, times.end());
  return 1e9 * times[blocks / 2];
}

static void time_algorithms(const Arm& arm, const std::vector<State>& states, int blocks) {
  const pin::Model& model = arm.model;
  pin::Data data(model);
  auto print = [&](const char* algorithm, double ns) {
    std::printf("{\"robot\":\"%s\",\"algorithm\":\"%s\",\"ns\":%.2f}\n", arm.name.c_str(), algorithm, ns);
    std::fflush(stdout);
  };
  auto faster = [&](auto call) {
    const double local =
        median_ns(blocks, states, [&](const State& s) { call(s, pin::Convention::LOCAL); });
    const double world =
        median_ns(blocks, states, [&](const State& s) { call(s, pin::Convention::WORLD); });
    return std::min(local, world);
  };
  print("rnea", median_ns(blocks, states,
                          [&](const State& s) { pin::rnea(model, data, s.q, s.qd, s.qdd); }));
  print("aba", faster([&](const State& s, pin::Convention c) {
          pin::aba(model, data, s.q, s.qd, s.tau, c);
        }));
  print("crba",
        faster([&](const State& s, pin::Convention c) { pin::crba(model, data, s.q, c); }));
  print("fk", median_ns(blocks, states,
                        [&](const State& s) { pin::forwardKinematics(model, data, s.q); }));
  print("regressor", median_ns(blocks, states, [&](const State& s) {
          pin::computeJointTorqueRegressor(model, data, s.q, s.qd, s.qdd);
        }));
  print("jacobian", median_ns(blocks, states, [&](const State& s) {
          pin::computeJointJacobians(model, data, s.q);
        }));
  print("bias", median_ns(blocks, states, [&](const State& s) {
          pin::nonLinearEffects(model, data, s.q, s.qd);
        }));
  print("gravity", median_ns(blocks, states, [&](const State& s) {
          pin::computeGeneralizedGravity(model, data, s.q);
        }));
}

// Computed torque at 1 kHz along one sinusoid per joint, and a plant of four ABAs (RK4) per step.
struct Loop {
  static constexpr double step = 1e-3, kp = 400.0, kd = 40.0, amplitude = 0.3;
  const pin::Model& model;
  pin::Data data;
  Vector q, qd, reference, d_reference, dd_reference, frequency, tau, k1, k2, k3, k4, mid, d_mid;
  double error_peak = 0.0;
  long steps = 0;

  explicit Loop(const pin::Model& m) : model(m), data(m) {
    const int n = m.nv;
    for (Vector* v : {&q, &qd, &reference, &d_reference, &dd_reference, &frequency, &tau, &k1, &k2,
                      &k3, &k4, &mid, &d_mid})
      v->setZero(n);
    for (int i = 0; i < n; ++i) frequency[i] = 2.0 * M_PI * (0.2 + 0.05 * i);
    qd = amplitude * frequency;
  }

  void advance() {
    const double t = step * double(steps++);
    for (int i = 0; i < q.size(); ++i) {
      const double w = frequency[i], s = std::sin(w * t), c = std::cos(w * t);
      reference[i] = amplitude * s;
      d_reference[i] = amplitude * w * c;
      dd_reference[i] = -amplitude * w * w * s;
    }
    error_peak = std::max(error_peak, (q - reference).cwiseAbs().maxCoeff());
    mid = dd_reference - kd * (qd - d_reference) - kp * (q - reference);
    tau = pin::rnea(model, data, q, qd, mid);
    runge_kutta();
  }

  void runge_kutta() {
    k1 = pin::aba(model, data, q, qd, tau);
    mid = q + 0.5 * step * qd;
    d_mid = qd + 0.5 * step * k1;
    k2 = pin::aba(model, data, mid, d_mid, tau);
    mid = q + 0.5 * step * qd + 0.25 * step * step * k1;
    d_mid = qd + 0.5 * step * k2;
    k3 = pin::aba(model, data, mid, d_mid, tau);
    mid = q + step * qd + 0.5 * step * step * k2;
    d_mid = qd + step * k3;
    k4 = pin::aba(model, data, mid, d_mid, tau);
    q += step * qd + step * step / 6.0 * (k1 + k2 + k3);
    qd += step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
};

static void time_loop(const Arm& arm, const std::vector<State>& states, int blocks) {
  Loop loop(arm.model);
  const double ns = median_ns(blocks, states, [&](const State&) { loop.advance(); });
  if (!(loop.error_peak < 1e-3)) {
    std::fprintf(stderr, "%s: the closed loop lost its reference by %g rad\n", arm.name.c_str(),
                 loop.error_peak);
    std::exit(1);
  }
  std::printf("{\"robot\":\"%s\",\"algorithm\":\"closed_loop_rk4\",\"times_real_time\":%.2f}\n",
              arm.name.c_str(), 1e9 * Loop::step / ns);
}

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: pinocchio ARMS [blocks]\n");
    return 2;
  }
  const int blocks = argc > 2 ? std::atoi(argv[2]) : 301;
  for (const Arm& arm : read_arms(argv[1])) {
    const std::vector<State> states = random_states(arm.model.nv);
    check(arm, states);
    time_algorithms(arm, states, blocks);
    if (arm.name == "panda") time_loop(arm, states, blocks);
  }
}
