#pragma once

#include <string>

#include "limb_ring/payload/byte_view.h"
#include "limb_ring/payload/expected.h"

namespace limb_ring::payload {

/// The name and type of a topic, sent as a separate message, in fragments, before the first data of that topic. (ours)
///
///   | version 8 | flags 8 | name | datatype | md5sum | definition |
///     name, datatype, md5sum: length u16 and so many bytes; definition: length u32 and bytes
///     flags: bit 0 latching; neither datatype nor md5sum is empty or "*"
struct Announcement {
  std::string name;        ///< of the topic where it comes out
  std::string datatype;    ///< "sensor_msgs/Image"
  std::string md5sum;      ///< of the type, 32 hexadecimal digits in ROS 1
  std::string definition;  ///< full text of the message definition, as rosbag stores it
  bool latching = false;   ///< late subscribers get the last message

  bool operator==(const Announcement& other) const;
};

/// @return EncodeFailure: too_large if a text does not fit its length field
///         (item 0 name, 1 datatype, 2 md5sum, 3 definition)
Encoded encode(const Announcement& announcement);
Decoded<Announcement> decode_announcement(ByteView message);

}  // namespace limb_ring::payload
