#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "io/unique_fd.h"
#include "io/unix_socket.h"
#include "wire/bytes.h"

namespace limb_ring::link {

using process::would_block;

/// What a line's socket holds at most, as far as the kernel lets us: more than a ring of 254
/// full packets.
constexpr int kSocketBuffer = 1 << 20;

/// Connects without waiting. @return an invalid one if nobody of our user listens, or the queue is full
process::UniqueFd connect_unix(const std::string& path);

void enlarge_buffers(int socket);
/// The other end is closed; what it sent before may still wait.
bool has_hung_up(int socket);

/// As send() and recv(), but they never wait and raise no signal. @return bytes, or -1 with errno
ssize_t send_now(int socket, wire::ByteView bytes);
ssize_t receive_now(int socket, std::uint8_t* space, std::size_t size);
/// The same with descriptors, at most kMostDescriptors: they come with the first of the bytes.
constexpr std::size_t kMostDescriptors = 2;
ssize_t send_now(int socket, wire::ByteView bytes, const std::vector<int>& descriptors);
/// @param descriptors those that came are added
ssize_t receive_now(int socket, std::uint8_t* space, std::size_t size, std::vector<process::UniqueFd>& descriptors);

}  // namespace limb_ring::link
