#pragma once

#include "core/fold_back.h"
#include "link/input.h"
#include "link/output.h"
#include "runtime/faulty_line.h"
#include "runtime/settings.h"

namespace limb_ring::runtime {

/// The links of the second line, which runs against the ring, and the fold between the four lines and the
/// controller. (ours, protocol.md section 8)
class SecondLine final : private link::InputHandler, private link::OutputHandler {
 public:
  /// Who drives it.
  struct Driver {
    /// The instant of what is coming in now.
    virtual core::Time begin_batch() = 0;
    virtual core::Time now() const = 0;
    virtual void pump() = 0;
    /// For people.
    virtual void say(std::string_view what) = 0;

   protected:
    ~Driver() = default;
  };

  SecondLine(boost::asio::io_context& io, const Clock& clock, const LinkSettings::Ends& ends,
             core::Controller& controller, core::FoldBack::Receiver& receiver, Driver& driver);

  core::FoldBack& fold() { return fold_; }
  const core::FoldBack& fold() const { return fold_; }
  const link::Input& input() const { return input_; }
  const link::Output& output() const { return output_; }
  FaultyLine& faulty_line() { return faulty_line_; }
  const FaultyLine& faulty_line() const { return faulty_line_; }
  /// Puts onto the line what the fold has for it.
  void write();
  void close();
  void listen_again() { input_.listen_again(); }

 private:
  void on_slice(const wire::Slice& slice) override;
  void on_batch_end() override;
  void on_input_gap(std::uint32_t lost) override;
  void on_input_up(std::uint8_t from) override;
  void on_input_lost(std::string_view reason) override;
  void on_stranger(std::string_view reason) override;
  void on_output_up(std::uint8_t to) override;
  void on_output_lost(std::string_view reason) override;
  void on_output_refused(std::uint8_t by, std::string_view reason) override;
  void on_output_ready() override;

  core::Controller& controller_;
  Driver& driver_;
  core::FoldBack fold_;
  link::Input input_;
  link::Output output_;
  FaultyLine faulty_line_;
};

}  // namespace limb_ring::runtime
