// gains.json, as `phihat design` writes it.
#ifndef PHIHAT_CONTROLLER__GAINS_FILE_HPP_
#define PHIHAT_CONTROLLER__GAINS_FILE_HPP_

#include <string>
#include <string_view>
#include <vector>

#include "phihat.h"

namespace phihat_ros
{

/// What a gains document says of a controller's laws and of the loop that they are for.
struct Gains
{
  double rate_hz = 0.0;
  /// Names, in the document's order.
  std::vector<std::string> names;
  /// Laws in the same order. Limits are those that the certificate was made with; INFINITY: it names none.
  std::vector<phihat_joint> joints;
  /// Transport delay from sample to torque that the gains are for [samples], per joint.
  std::vector<unsigned> delay_samples;
  bool certified = false;
  /// Why the certificate does not let the gains arm, or is about another loop than this one; empty: it does.
  std::string reservation;
};

/// Reads a document. The certificate is read, not verified: that is what `phihat verify` does.
/// Throws std::runtime_error: not JSON, another kind of document or version, members missing or of no use.
Gains read_gains(std::string_view text);

/// The same from a file; what is thrown names it.
Gains read_gains_file(const std::string & path);

}  // namespace phihat_ros

#endif  // PHIHAT_CONTROLLER__GAINS_FILE_HPP_
