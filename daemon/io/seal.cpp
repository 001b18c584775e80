#include "io/seal.h"

#include <sodium.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace limb_ring::link {
namespace {

static_assert(kTagSize == crypto_aead_chacha20poly1305_ietf_ABYTES);
static_assert(sizeof(Key) == crypto_aead_chacha20poly1305_ietf_KEYBYTES);

using CipherNonce = std::array<std::uint8_t, crypto_aead_chacha20poly1305_ietf_NPUBBYTES>;

void start_sodium() {
  static const int started = ::sodium_init();
  if (started < 0) throw std::runtime_error("libsodium cannot be used: it finds no random numbers");
}

CipherNonce cipher_nonce(std::uint64_t number) {
  CipherNonce nonce{};
  wire::store_u64(nonce.data() + nonce.size() - 8, number);
  return nonce;
}

/// BLAKE2b with a key, of several pieces one after another.
class KeyedHash {
 public:
  KeyedHash(const Key& key, std::size_t size) : size_(size) {
    ::crypto_generichash_init(&state_, key.data(), key.size(), size_);
  }
  KeyedHash& add(wire::ByteView bytes) {
    ::crypto_generichash_update(&state_, bytes.data, bytes.size);
    return *this;
  }
  KeyedHash& add(std::uint64_t number) {
    std::array<std::uint8_t, 8> bytes;
    wire::store_u64(bytes.data(), number);
    return add({bytes.data(), bytes.size()});
  }
  void write(std::uint8_t* out) { ::crypto_generichash_final(&state_, out, size_); }

 private:
  crypto_generichash_state state_;
  std::size_t size_;
};

Key derived(const Key& ring_key, const char* purpose, std::uint64_t ring, bool second_line) {
  Key key;
  KeyedHash(ring_key, key.size())
      .add({reinterpret_cast<const std::uint8_t*>(purpose), std::strlen(purpose)})
      .add(ring)
      .add(second_line ? 2 : 1)
      .write(key.data());
  return key;
}

}  // namespace

Nonce fresh_long_nonce() {
  start_sodium();
  Nonce nonce;
  ::randombytes_buf(nonce.data(), nonce.size());
  return nonce;
}

// ---- a session ----------------------------------------------------------------------------

bool ReplayWindow::take(std::uint64_t number) {
  if (number == 0) return false;
  if (number > highest_) {
    const std::uint64_t last = highest_ / 64, now = number / 64;
    for (std::uint64_t word = std::max(last + 1, now >= kWords ? now - kWords + 1 : 0); word <= now; ++word)
      seen_[word % kWords] = 0;
    highest_ = number;
  } else if (highest_ - number >= kSize) {
    return false;
  }
  std::uint64_t& word = seen_[number / 64 % kWords];
  const std::uint64_t bit = std::uint64_t{1} << number % 64;
  if ((word & bit) != 0) return false;
  word |= bit;
  return true;
}

void Sealer::seal(std::uint8_t* datagram, std::size_t size) {
  const CipherNonce nonce = cipher_nonce(++number_);
  wire::store_u64(datagram + size, number_);
  unsigned long long tag_size = 0;
  std::uint8_t nothing = 0;  // nothing is encrypted, but libsodium wants a place for it that is not null
  ::crypto_aead_chacha20poly1305_ietf_encrypt_detached(&nothing, datagram + size + 8, &tag_size, nullptr, 0, datagram,
                                                       size, nullptr, nonce.data(), key_.data());
}

Opener::Verdict Opener::open(wire::ByteView datagram) {
  if (datagram.size < kSealSize) return Verdict::truncated;
  const std::size_t size = datagram.size - kSealSize;
  const std::uint64_t number = wire::load_u64(datagram.data + size);
  const CipherNonce nonce = cipher_nonce(number);
  const std::uint8_t nothing = 0;  // as above
  if (::crypto_aead_chacha20poly1305_ietf_decrypt_detached(nullptr, nullptr, &nothing, 0, datagram.data + size + 8,
                                                           datagram.data, size, nonce.data(), key_.data()) != 0)
    return Verdict::forged;
  return window_.take(number) ? Verdict::good : Verdict::replayed;
}

// ---- the handshake ------------------------------------------------------------------------

LineKey::LineKey(const Key& ring_key, std::uint64_t ring, bool second_line) {
  start_sodium();
  handshake_ = derived(ring_key, "limb_ring handshake 3", ring, second_line);
  sessions_ = derived(ring_key, "limb_ring sessions 3", ring, second_line);
}

Tag LineKey::tag(wire::ByteView message, const Nonce& asker, std::uint8_t to) const {
  Tag tag;
  KeyedHash(handshake_, tag.size()).add(message).add({asker.data(), asker.size()}).add({&to, 1}).write(tag.data());
  return tag;
}

bool LineKey::check(wire::ByteView message, const Nonce& asker, std::uint8_t to, const std::uint8_t* given) const {
  const Tag right = tag(message, asker, to);
  return ::sodium_memcmp(right.data(), given, right.size()) == 0;
}

SessionKeys LineKey::session(const Handshake& handshake) const {
  std::array<std::uint8_t, 64> both;
  KeyedHash(sessions_, both.size())
      .add({handshake.asker.data(), handshake.asker.size()})
      .add({handshake.answerer.data(), handshake.answerer.size()})
      .add(handshake.session)
      .add({&handshake.from, 1})
      .add({&handshake.to, 1})
      .write(both.data());
  SessionKeys keys;
  std::copy(both.begin(), both.begin() + 32, keys.forward.begin());
  std::copy(both.begin() + 32, both.end(), keys.backward.begin());
  return keys;
}

}  // namespace limb_ring::link
