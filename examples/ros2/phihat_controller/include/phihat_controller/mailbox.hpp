// The newest value from one thread to another, without a lock.
#ifndef PHIHAT_CONTROLLER__MAILBOX_HPP_
#define PHIHAT_CONTROLLER__MAILBOX_HPP_

#include <array>
#include <atomic>

namespace phihat_ros
{

/// Three places: the sender's, the receiver's, and the newest value between them. One sender, one receiver;
/// neither ever waits, and nothing is allocated after the constructor as long as a value's own room suffices.
template<class T>
class Mailbox
{
public:
  explicit Mailbox(const T & empty = T()) : places_{empty, empty, empty} {}

  /// The sender's place: fill it, then send().
  T & place() { return places_[mine_]; }

  void send() { mine_ = between_.exchange(mine_ | NEW, std::memory_order_acq_rel) & ~NEW; }

  /// Takes the newest value, if there is one since the last time; newest() is it then.
  bool take()
  {
    if ((between_.load(std::memory_order_relaxed) & NEW) == 0) {
      return false;
    }
    yours_ = between_.exchange(yours_, std::memory_order_acq_rel) & ~NEW;
    return true;
  }

  const T & newest() const { return places_[yours_]; }

private:
  static constexpr unsigned NEW = 4;

  std::array<T, 3> places_;
  unsigned mine_ = 0;
  unsigned yours_ = 1;
  std::atomic<unsigned> between_{2};
};

}  // namespace phihat_ros

#endif  // PHIHAT_CONTROLLER__MAILBOX_HPP_
