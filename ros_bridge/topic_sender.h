#pragma once

#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "config/ring_config.h"
#include "limb_ring/payload/announcement.h"
#include "limb_ring/payload/fragmenter.h"
#include "limb_ring/payload/reassembler.h"
#include "ros_bridge/counters.h"
#include "ros_bridge/ring_port.h"

namespace limb_ring::bridge {

/// A serialized ROS message and what it is.
struct TopicMessage {
  payload::Announcement type;
  std::vector<std::uint8_t> bytes;
};

/// Whether two types are the same: two publishers may word the definition of one type differently, as roscpp and rospy
/// do. (ours)
inline bool is_same_type(const payload::Announcement& one, const payload::Announcement& other) {
  return one.datatype == other.datatype && one.md5sum == other.md5sum;
}

/// Sends the messages of one topic to one node, in fragments, on channel 3. No ROS, no threads.
///
/// At most `kWindow` fragments are under way, so that a large message never fills the
/// controller's send queue. The topic's type goes before its first message, whenever it
/// changes, and once a second (announce()), because the far side may have restarted. After a
/// fragment that was not delivered the rest of its message is not sent. A latched topic's last
/// message is sent again, with the next announce(), until it has arrived.
///
/// If a topic has several publishers, the definition of the first one counts, and the topic is latched as soon as one
/// of them latches: at the far side there is one publisher for all of them. (ours)
class TopicSender {
 public:
  static constexpr unsigned kWindow = 4;
  /// Largest message or type in bytes: what the other bridge reassembles. Fragments could carry more.
  static constexpr std::size_t kLargest = payload::Reassembler::Limits{}.message;
  using Send = std::function<void(const Outgoing&, RingPort::OnResult)>;
  using OnTooLarge = std::function<void(std::size_t bytes)>;

  /// `number` is the topic's place in the configuration's list, the same at both ends.
  /// @param on_too_large is told of each message above kLargest; it is not sent, and counted
  TopicSender(std::uint8_t number, const config::TopicConfig& topic, Send send, OnTooLarge on_too_large,
              Counters& counters);

  /// Queues a message; at `topic.queue` the oldest one waiting is dropped, and counted.
  void offer(TopicMessage message);
  /// Announces the type again, as soon as the message under way has gone.
  void announce();
  /// The far side has restarted: type first, and a latched topic's last message again.
  void far_side_restarted();

 private:
  /// A message of which some fragments are under way.
  struct Flight {
    bool announcement = false;
    bool failed = false;
    bool all_sent = false;
    unsigned unanswered = 0;
  };
  void pump();
  bool has_fragment();
  bool takes_new_type();
  bool start_announcement();
  bool start_message();
  bool start(payload::Fragment::Kind kind, std::vector<std::uint8_t> bytes);
  void begin_flight(bool announcement);
  void send_fragment();
  void on_result(std::uint64_t serial, const Result& result);
  void fail(Flight& flight, std::uint64_t serial, Outcome outcome);
  void finish(const Flight& flight);
  void count(const std::string& what) { counters_.add(prefix_ + what); }
  void lose(const std::string& what) { counters_.lose(prefix_ + what); }

  payload::Fragmenter fragmenter_;
  config::TopicConfig topic_;
  Send send_;
  OnTooLarge on_too_large_;
  Counters& counters_;
  std::string prefix_;

  std::deque<TopicMessage> waiting_;
  std::optional<payload::Announcement> type_;  // announced last
  std::optional<TopicMessage> latched_;
  bool latched_missing_ = false;  // the far side has not got it: it is sent again with the next announce()
  bool announce_due_ = false;     // announce before the next message
  bool type_is_known_ = false;    // the announcement arrived: messages may follow

  std::map<std::uint64_t, Flight> flights_;  // by serial number
  std::uint64_t serial_ = 0;                 // of the message in the fragmenter
  bool given_up_ = false;                    // the rest of it is not sent
  unsigned under_way_ = 0;                   // fragments, of all flights
};

}  // namespace limb_ring::bridge
