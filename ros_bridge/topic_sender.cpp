#include "ros_bridge/topic_sender.h"

#include "limb_ring/payload/packet_type.h"
#include "ring/reset_node.h"
#include "ros_bridge/conversions.h"

namespace limb_ring::bridge {

using payload::Fragment;

TopicSender::TopicSender(std::uint8_t number, const config::TopicConfig& topic, Send send, OnTooLarge on_too_large,
                         Counters& counters)
    : fragmenter_(number),
      topic_(topic),
      send_(std::move(send)),
      on_too_large_(std::move(on_too_large)),
      counters_(counters),
      prefix_("topic_" + topic.input + "_") {}

void TopicSender::offer(TopicMessage message) {
  message.type.name = topic_.output;
  if (waiting_.size() >= topic_.queue) {
    waiting_.pop_front();
    lose("dropped_queue");
  }
  waiting_.push_back(std::move(message));
  pump();
}

void TopicSender::announce() {
  announce_due_ = type_.has_value();
  if (latched_missing_ && waiting_.empty()) waiting_.push_back(*latched_);
  pump();
}

void TopicSender::far_side_restarted() {
  type_is_known_ = false;
  latched_missing_ = latched_.has_value();
  announce();
}

void TopicSender::pump() {
  while (under_way_ < kWindow && has_fragment()) send_fragment();
}

// A message may follow another while that is still under way. An announcement waits until all
// that went before it is answered for: it starts the topic afresh at the far side.
bool TopicSender::has_fragment() {
  if (!fragmenter_.done() && !given_up_) return true;
  if (takes_new_type()) announce_due_ = true;
  if (announce_due_) return under_way_ == 0 && start_announcement();
  return start_message();
}

/// Whether the next message is of another type than was announced, or makes it a latched one.
bool TopicSender::takes_new_type() {
  if (waiting_.empty()) return false;
  const payload::Announcement& next = waiting_.front().type;
  if (!type_ || !is_same_type(*type_, next)) {
    type_ = next;
    return true;
  }
  const bool latches = next.latching && !type_->latching;
  type_->latching |= latches;
  return latches;
}

bool TopicSender::start_announcement() {
  announce_due_ = false;
  type_is_known_ = false;
  const auto bytes = payload::encode(*type_);
  if (!bytes || !start(Fragment::Kind::announcement, *bytes)) {
    lose("dropped_type_too_large");
    waiting_.clear();
    return false;
  }
  begin_flight(true);
  return true;
}

bool TopicSender::start_message() {
  while (type_is_known_ && !waiting_.empty()) {
    TopicMessage message = std::move(waiting_.front());
    waiting_.pop_front();
    latched_.reset();
    latched_missing_ = false;
    if (type_->latching) latched_ = message;
    const std::size_t size = message.bytes.size();
    if (start(Fragment::Kind::data, std::move(message.bytes))) {
      begin_flight(false);
      return true;
    }
    latched_.reset();
    lose("dropped_too_large");
    on_too_large_(size);
  }
  return false;
}

bool TopicSender::start(Fragment::Kind kind, std::vector<std::uint8_t> bytes) {
  return bytes.size() <= kLargest && fragmenter_.start(kind, std::move(bytes));
}

void TopicSender::begin_flight(bool announcement) {
  flights_[++serial_].announcement = announcement;
  given_up_ = false;
}

void TopicSender::send_fragment() {
  Flight& flight = flights_[serial_];
  ++under_way_;
  ++flight.unanswered;
  Outgoing packet{topic_.to, topic_.priority, payload::kTopicChannel, fragmenter_.next()};
  flight.all_sent = fragmenter_.done();
  send_(packet, [this, serial = serial_](const Result& result) { on_result(serial, result); });
}

void TopicSender::on_result(std::uint64_t serial, const Result& result) {
  Flight& flight = flights_[serial];
  --under_way_;
  --flight.unanswered;
  if (!ask::may_have_arrived(result) && !flight.failed) {
    fail(flight, serial, result.outcome);
    given_up_ = given_up_ || serial == serial_;
  }
  if (flight.unanswered == 0 && (flight.all_sent || flight.failed)) {
    finish(flight);
    flights_.erase(serial);
  }
  pump();
}

// After a failed announcement nothing is sent until the next announce(): there may be nobody to
// listen, and asking again at once would only load the ring.
void TopicSender::fail(Flight& flight, std::uint64_t serial, Outcome outcome) {
  flight.failed = true;
  type_is_known_ = false;
  announce_due_ = !flight.announcement;
  if (flight.announcement)
    count("announcement_" + outcome_word(outcome));
  else
    lose("dropped_" + outcome_word(outcome));
  if (!flight.announcement && serial == serial_) latched_missing_ = latched_.has_value();
}

void TopicSender::finish(const Flight& flight) {
  if (flight.failed) return;
  if (flight.announcement)
    type_is_known_ = true;
  else
    count("sent");
}

}  // namespace limb_ring::bridge
