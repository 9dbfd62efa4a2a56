// Values of ros2_control's interfaces, whichever release they are of.
#ifndef PHIHAT_CONTROLLER__INTERFACES_HPP_
#define PHIHAT_CONTROLLER__INTERFACES_HPP_

#include <limits>
#include <type_traits>
#include <utility>

namespace phihat_ros
{

template<class T, class = void>
struct HasOptional : std::false_type {};

/// Jazzy and newer: get_optional(), which is empty where the value is being written just now.
template<class T>
struct HasOptional<T, std::void_t<decltype(std::declval<const T &>().get_optional())>> : std::true_type {};

/// The value of a state interface; NaN where there is none, as a driver of Humble says it.
template<class Interface>
double value_of(const Interface & interface)
{
  if constexpr (HasOptional<Interface>::value) {
    const auto value = interface.get_optional();
    return value.has_value() ? *value : std::numeric_limits<double>::quiet_NaN();
  } else {
    return interface.get_value();
  }
}

/// Writes a command; whether it went out. Humble's cannot fail.
template<class Interface>
bool write_to(Interface & interface, double value)
{
  if constexpr (std::is_void_v<decltype(interface.set_value(value))>) {
    interface.set_value(value);
    return true;
  } else {
    return interface.set_value(value);
  }
}

}  // namespace phihat_ros

#endif  // PHIHAT_CONTROLLER__INTERFACES_HPP_
