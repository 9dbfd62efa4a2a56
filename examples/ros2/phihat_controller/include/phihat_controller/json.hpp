// JSON (RFC 8259) read into a tree; for files that are read once, not for the control loop.
#ifndef PHIHAT_CONTROLLER__JSON_HPP_
#define PHIHAT_CONTROLLER__JSON_HPP_

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace phihat_ros
{

/// A value of a document. A missing member is a null one, so that what is optional reads like what is there.
struct Json
{
  enum class Kind { Null, False, True, Number, Text, List, Object };

  Kind kind = Kind::Null;
  double number = 0.0;
  std::string text;
  std::vector<Json> list;
  std::vector<std::pair<std::string, Json>> members;

  /// The member of this name; null where there is none, or where this is no object.
  const Json & operator[](std::string_view name) const;

  bool is(Kind wanted) const { return kind == wanted; }
};

/// Reads a document. Numbers are read to the nearest double, whatever the locale.
/// Throws std::runtime_error with line and column: not JSON, a key twice, nested deeper than 64.
Json read_json(std::string_view text);

}  // namespace phihat_ros

#endif  // PHIHAT_CONTROLLER__JSON_HPP_
