#pragma once

#include <chrono>
#include <map>
#include <string>

namespace limb_ring::bridge {

/// What happened lately, each told for a while: a diagnostics reader that reads once a second would
/// miss what came and went between two readings.
class Recent {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Recent(Clock::duration hold) : hold_(hold) {}

  /// The newest text of a key replaces the one before.
  void note(const std::string& key, const std::string& text, Clock::time_point now) { notes_[key] = {text, now}; }

  /// Calls visit(text) for each that is not older than the hold; forgets the others.
  template <class Visit>
  void each(Clock::time_point now, Visit visit) {
    for (auto note = notes_.begin(); note != notes_.end();) {
      if (now - note->second.at > hold_) {
        note = notes_.erase(note);
      } else {
        visit(note->second.text);
        ++note;
      }
    }
  }

 private:
  struct Note {
    std::string text;
    Clock::time_point at;
  };
  Clock::duration hold_;
  std::map<std::string, Note> notes_;
};

}  // namespace limb_ring::bridge
