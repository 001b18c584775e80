#pragma once

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "core/archive.h"

namespace limb_ring::recorder {

/// Values as text, with the names of their members: all in one line, "from 3 line 0", or one per line with the path to
/// the member, "membership.peers[4].boot 17". (ours)
class TextArchive : public core::Archive<TextArchive> {
 public:
  enum class Form { one_line, lines };
  explicit TextArchive(Form form) : form_(form) {}
  const std::string& text() const { return text_; }

 private:
  friend class core::Archive<TextArchive>;
  void enter(const char* name) {
    lengths_.push_back(path_.size());
    if (*name == 0) return;
    if (form_ == Form::one_line)
      path_ = name;
    else
      path_ += (path_.empty() ? "" : ".") + std::string(name);
  }
  void element(std::size_t i) {
    lengths_.push_back(path_.size());
    if (form_ == Form::lines) path_ += '[' + std::to_string(i) + ']';
  }
  void leave() {
    path_.resize(std::min(path_.size(), lengths_.back()));
    lengths_.pop_back();
  }
  void say(const std::string& value) {
    if (form_ == Form::lines)
      text_ += path_ + ' ' + value + '\n';
    else
      text_ += (text_.empty() ? "" : " ") + path_ + ' ' + value;
  }
  template <class T>
  void plain(const T& what) {
    if constexpr (std::is_same_v<T, core::Int128>) {
      if (what == core::kNever.time_since_epoch().count()) return say("never");
      char text[48];
      std::snprintf(text, sizeof text, "%.12Lf s", static_cast<long double>(what) / 1e12L);
      say(text);
    } else if constexpr (std::is_enum_v<T>) {
      say(std::to_string(static_cast<std::underlying_type_t<T>>(what)));
    } else {
      say(std::to_string(what));
    }
  }
  void bytes(const void* from, std::size_t size) {
    const auto* first = static_cast<const std::uint8_t*>(from);
    view({first, size});
  }
  void view(const wire::ByteView& what) {
    std::string hex;
    char digits[3];
    for (const std::uint8_t byte : what) {
      std::snprintf(digits, sizeof digits, "%02x", byte);
      hex += digits;
    }
    say(hex.empty() ? "-" : hex);
  }
  std::size_t count(std::size_t size) { return size; }

  Form form_;
  std::string text_, path_;
  std::vector<std::size_t> lengths_;
};

}  // namespace limb_ring::recorder
