#include "phihat_controller/gains_file.hpp"

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "phihat_controller/json.hpp"

namespace phihat_ros
{

namespace
{

constexpr double VERSION = 3.0;
constexpr double NONE = std::numeric_limits<double>::infinity();

double number(const Json & of, const char * name, const std::string & where)
{
  const Json & value = of[name];
  if (!value.is(Json::Kind::Number)) {
    throw std::runtime_error(where + ": " + name + " is not there, or no number");
  }
  return value.number;
}

/// Copies a list of numbers into an array of C; how many.
std::size_t numbers(const Json & from, double * to, std::size_t room, const std::string & where)
{
  if (!from.is(Json::Kind::List) || from.list.empty() || from.list.size() > room) {
    throw std::runtime_error(where + ": a list of 1 to " + std::to_string(room) + " numbers is expected");
  }
  for (std::size_t i = 0; i < from.list.size(); ++i) {
    if (!from.list[i].is(Json::Kind::Number)) {
      throw std::runtime_error(where + ": entry " + std::to_string(i) + " is no number");
    }
    to[i] = from.list[i].number;
  }
  return from.list.size();
}

unsigned samples(double value, const std::string & where)
{
  if (!(value >= 0.0 && value <= 64.0) || std::floor(value) != value) {
    throw std::runtime_error(where + ": delay_samples is not a whole number from 0 to 64");
  }
  return static_cast<unsigned>(value);
}

/// The filter on the innovation; without one in the document there is none.
void filter(const Json & sections, phihat_joint & joint, const std::string & where)
{
  if (sections.is(Json::Kind::Null)) {
    return;
  }
  if (!sections.is(Json::Kind::List) || sections.list.size() > PHIHAT_SECTIONS_MAX) {
    throw std::runtime_error(
      where + ": innovation_filter is no list of up to " + std::to_string(PHIHAT_SECTIONS_MAX) + " sections");
  }
  for (std::size_t i = 0; i < sections.list.size(); ++i) {
    const auto pair = [&](const char * name, double * to) {
        const std::string what = where + ": innovation_filter: section " + std::to_string(i) + ": " + name;
        if (numbers(sections.list[i][name], to, 2, what) != 2) {
          throw std::runtime_error(what + ": two numbers are expected");
        }
      };
    pair("rates", joint.section_rates[i]);
    pair("weights_per_s2", joint.section_weights_per_s2[i]);
  }
  joint.sections = sections.list.size();
}

/// One joint's law; its limits are not known here.
phihat_joint law(const Json & record, const std::string & where, unsigned & delay)
{
  phihat_joint joint;
  std::memset(&joint, 0, sizeof joint);
  joint.size = sizeof joint;
  joint.inertia_kg_m2 = number(record, "inertia_kg_m2", where);
  joint.kp_per_s2 = number(record, "kp_per_s2", where);
  joint.kd_per_s = number(record, "kd_per_s", where);
  joint.torque_max_nm = NONE;
  joint.torque_rate_max_nm_s = NONE;
  const Json & observer = record["observer"];
  if (observer.is(Json::Kind::Object)) {
    joint.form = PHIHAT_FORM_POSITIONS;
    const std::size_t states =
      numbers(observer["correction"], joint.correction, PHIHAT_CORRECTION_MAX, where + ": correction");
    if (states < 3) {
      throw std::runtime_error(where + ": correction has fewer than 3 entries");
    }
    joint.order = static_cast<uint32_t>(states - 2);
    joint.share = number(observer, "share", where);
    delay = samples(number(observer, "delay_samples", where), where);
    joint.delay_samples = delay;
    filter(observer["innovation_filter"], joint, where);
  } else {
    joint.form = PHIHAT_FORM_OBSERVER;
    joint.order = static_cast<uint32_t>(numbers(record["a"], joint.a, PHIHAT_ORDER_MAX, where + ": a"));
  }
  return joint;
}

/// What the certificate adds to a joint: the loop that it is about, and the limits in it.
void certificate(Gains & gains, std::size_t i, const Json & claims)
{
  const std::string where = "certificate of " + gains.names[i];
  phihat_joint & joint = gains.joints[i];
  if (claims["name"].text != gains.names[i]) {
    throw std::runtime_error(where + ": it is about joint \"" + claims["name"].text + "\"");
  }
  const Json & limits = claims["limits"];
  if (limits.is(Json::Kind::List) && limits.list.size() == 2) {
    const auto limit = [](const Json & value) {return value.is(Json::Kind::Number) ? value.number : NONE;};
    joint.torque_max_nm = limit(limits.list[0]);
    joint.torque_rate_max_nm_s = limit(limits.list[1]);
  }
  if (!claims["refused"].list.empty()) {
    gains.reservation = where + ": " + std::to_string(claims["refused"].list.size()) +
      " of its claims do not hold: such gains do not arm";
  }
  const Json & model = claims["model"];
  gains.delay_samples[i] = samples(number(model, "delay_samples", where), where);
  if (joint.form == PHIHAT_FORM_POSITIONS) {
    return;
  }
  if (model["form"].text == "literal") {
    joint.form = PHIHAT_FORM_LITERAL;
  }
  const bool filtered = model["velocity_filter_hz"].is(Json::Kind::Number);
  if (model["velocity"].text != "measured" || filtered) {
    gains.reservation = where + ": it is about a velocity that is " + model["velocity"].text +
      (filtered ? " and filtered" : "") + "; this controller takes the velocity interface as it is. Design with "
      "sensor.velocity = \"measured\", or from positions";
  }
}

}  // namespace

Gains read_gains(std::string_view text)
{
  const Json document = read_json(text);
  if (document["format"].text != "phihat-gains") {
    throw std::runtime_error("not gains: `phihat design` writes gains");
  }
  const double version = number(document, "version", "gains");
  if (!(version >= VERSION && version <= VERSION)) {
    throw std::runtime_error(
      "version is " + std::to_string(static_cast<long>(version)) + "; this controller reads version 3");
  }
  Gains gains;
  gains.rate_hz = number(document, "rate_hz", "gains");
  if (!(gains.rate_hz >= 1.0 && gains.rate_hz <= 1e6)) {
    throw std::runtime_error("rate_hz is not between 1 and 1e6");
  }
  for (const Json & record : document["joints"].list) {
    const std::string name = record["name"].text;
    for (const std::string & other : gains.names) {
      if (other == name) {
        throw std::runtime_error("joint " + name + " is there twice");
      }
    }
    unsigned delay = 0;
    gains.joints.push_back(law(record, "joint " + name, delay));
    if (document["torque_filter_hz"].is(Json::Kind::Number)) {
      gains.joints.back().torque_filter_hz = document["torque_filter_hz"].number;
    }
    gains.delay_samples.push_back(delay);
    gains.names.push_back(name);
  }
  if (gains.names.empty()) {
    throw std::runtime_error("the gains are for no joint");
  }
  const Json & claims = document["certificate"];
  gains.certified = claims.is(Json::Kind::Object);
  if (gains.certified) {
    if (claims["joints"].list.size() != gains.names.size()) {
      throw std::runtime_error("the certificate is not about these joints");
    }
    for (std::size_t i = 0; i < gains.names.size(); ++i) {
      certificate(gains, i, claims["joints"].list[i]);
    }
  } else {
    gains.reservation = "the gains carry no certificate; `phihat design` writes gains that do";
  }
  return gains;
}

Gains read_gains_file(const std::string & path)
{
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw std::runtime_error(path + ": cannot be read");
  }
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  try {
    return read_gains(text);
  } catch (const std::runtime_error & why) {
    throw std::runtime_error(path + ": " + why.what());
  }
}

}  // namespace phihat_ros
