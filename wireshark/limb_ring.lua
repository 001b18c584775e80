-- Wireshark dissector of the ring network of articulated robots as limb_ring builds it. Its captures are
-- pcapng with LINKTYPE_USER0: a pseudo-header of 12 bytes, then a packet; docs/reference/captures.md describes both.
-- Install with scripts/install_dissector. Works with Wireshark 3.2 and later.

-- Installed, and named on the command line as well: the one that came first stays.
local known, dissector = pcall(Dissector.get, "limbring")
if known and dissector then return end

local ring = Proto("limbring", "Ring network of articulated robots")

local PSEUDO_SIZE, HEADER, TRAILER, CRC = 12, 4, 4, 4
local OVERHEAD = HEADER + TRAILER + CRC
local BROADCAST, UNTAKEN = 255, 255
local START = 0xFB
local CONTROL, JOINT = 1, 2

local kinds = {[0] = "DATP", [1] = "INTP"}
local channels = {[0] = "user", [1] = "control", [2] = "joint", [3] = "topic"}
local crc_status = {[0] = "Bad", [1] = "Good", [2] = "Unverified"}

local f = {}
local all = {}

local function field(name, make, ...)
  f[name] = make("limbring." .. name, ...)
  all[#all + 1] = f[name]
end

-- The pseudo-header: where and how the packet was seen.
field("capture.version", ProtoField.uint8, "Pseudo-header version")
field("capture.crc_bad", ProtoField.bool, "CRC was bad", 8, nil, 0x01)
field("capture.aborted", ProtoField.bool, "Aborted", 8, nil, 0x02)
field("capture.truncated", ProtoField.bool, "Truncated", 8, nil, 0x04)
field("capture.embedded", ProtoField.bool, "Embedded into a DATP", 8, nil, 0x08)
field("capture.retry", ProtoField.bool, "Retry", 8, nil, 0x10)
field("capture.own", ProtoField.bool, "Of the node that saw it", 8, nil, 0x20)
field("capture.input", ProtoField.bool, "Seen at an input", 8, nil, 0x40)
field("capture.event", ProtoField.bool, "Event, no packet", 8, nil, 0x80)
field("capture.from", ProtoField.uint8, "Line from node")
field("capture.to", ProtoField.uint8, "Line to node")
field("capture.span", ProtoField.uint32, "First to last slice (ns)")
field("carrier.sid", ProtoField.uint8, "Inside the DATP of node")
field("carrier.code", ProtoField.uint8, "Code of that DATP", base.HEX)
field("carrier.offset", ProtoField.uint16, "Bytes of it before")
field("event", ProtoField.string, "Event")

-- Header, data, trailer, CRC.
field("code", ProtoField.uint8, "Code", base.HEX)
field("incarnation", ProtoField.uint8, "Incarnation of the source", base.DEC, nil, 0xC0)
field("kind", ProtoField.uint8, "Kind", base.DEC, kinds, 0x20)
field("try", ProtoField.uint8, "Try", base.DEC, nil, 0x18)
field("seq", ProtoField.uint8, "Sequence", base.DEC, nil, 0x07)
field("sop", ProtoField.uint8, "SOP", base.HEX)
field("hop", ProtoField.uint8, "HOP")
field("sid", ProtoField.uint8, "SID, source")
field("data", ProtoField.bytes, "Data")
field("eop", ProtoField.uint8, "EOP", base.HEX)
field("fbc", ProtoField.uint8, "FBC, free buffers")
field("did", ProtoField.uint8, "DID, destination")
field("channel", ProtoField.uint8, "Channel", base.DEC, channels, 0xFC)
field("pri", ProtoField.uint8, "Priority (0 the highest)", base.DEC, nil, 0x03)
field("int", ProtoField.uint8, "Interrupt factor")
field("crc", ProtoField.uint32, "CRC", base.HEX)
field("crc.status", ProtoField.uint8, "CRC status", base.DEC, crc_status)

-- Channel 1: what network controllers tell each other.
-- (control messages), written by docs/generate_reference.py from daemon/wire/control_message.h
local cpu_states = {[0] = "none", "absent", "booting", "running", "silent", "failed"}
local link_states = {[0] = "down", "up", "silent", "folded"}
local control_types = {[1] = "hello", [2] = "beacon"}
field("control", ProtoField.uint8, "Control message", base.DEC, control_types)
field("boot", ProtoField.uint64, "Boot number")
field("hello.remembers", ProtoField.bool, "Remembers")
field("beacon.cpu_boots", ProtoField.uint32, "CPU boots")
field("beacon.cpu_state", ProtoField.uint8, "CPU state", base.DEC, cpu_states)
field("beacon.cpu_silent", ProtoField.uint32, "CPU silent (ms)")
field("beacon.input", ProtoField.uint8, "Input state", base.DEC, link_states)
field("beacon.input_from", ProtoField.uint8, "Input from (node)")
field("beacon.output", ProtoField.uint8, "Output state", base.DEC, link_states)
field("beacon.output_to", ProtoField.uint8, "Output to (node)")
field("beacon.break_known", ProtoField.bool, "Break known")
field("beacon.break_before", ProtoField.uint8, "Break before (node)")
field("beacon.break_behind", ProtoField.uint8, "Break behind (node)")
field("beacon.cpu_comes_back", ProtoField.bool, "CPU comes back")
field("beacon.stop_latched", ProtoField.bool, "Stop latched")
field("beacon.latch_count", ProtoField.uint32, "Clock latches")
field("beacon.latch_source", ProtoField.uint8, "Latch source (node)")
field("beacon.latch_clock", ProtoField.uint64, "Latched clock (ns)")
local control_fields = {
  [1] = {
    {"boot", 8},
    {"hello.remembers", 1},
  },
  [2] = {
    {"boot", 8},
    {"beacon.cpu_boots", 4},
    {"beacon.cpu_state", 1},
    {"beacon.cpu_silent", 4},
    {"beacon.input", 1},
    {"beacon.input_from", 1},
    {"beacon.output", 1},
    {"beacon.output_to", 1},
    {"beacon.break_known", 1},
    {"beacon.break_before", 1},
    {"beacon.break_behind", 1},
    {"beacon.cpu_comes_back", 1},
    {"beacon.stop_latched", 1},
    {"beacon.latch_count", 4},
    {"beacon.latch_source", 1},
    {"beacon.latch_clock", 8},
  },
}
local control_sizes = {[1] = {[10] = true}, [2] = {[26] = true, [40] = true}}
-- end of it.

-- Channel 2, type 1: joint states.
field("joint.sequence", ProtoField.uint16, "Joint state")
field("joint.position", ProtoField.double, "Position (rad, or m if it slides)")
field("joint.velocity", ProtoField.double, "Velocity (rad/s, or m/s if it slides)")
field("joint.effort", ProtoField.double, "Effort (N m, or N if it slides)")

ring.fields = all

local e = {
  crc = ProtoExpert.new("limbring.expert.crc", "CRC is bad", expert.group.CHECKSUM, expert.severity.ERROR),
  retry = ProtoExpert.new("limbring.expert.retry", "Sent again: this is no first try", expert.group.SEQUENCE,
                          expert.severity.NOTE),
  cut = ProtoExpert.new("limbring.expert.cut", "The packet was cut off on its way", expert.group.MALFORMED,
                        expert.severity.WARN),
  embedded = ProtoExpert.new("limbring.expert.embedded", "Interrupt packet inside a data packet",
                             expert.group.SEQUENCE, expert.severity.CHAT),
  refused = ProtoExpert.new("limbring.expert.refused", "Refused: FBC is 0", expert.group.RESPONSE_CODE,
                            expert.severity.NOTE),
}
ring.experts = {e.crc, e.retry, e.cut, e.embedded, e.refused}

local interface_name = Field.new("frame.interface_name")
local frame_comment = Field.new("frame.comment")

-- CRC-32 of IEEE 802.3, as signed 32-bit numbers: what the bit library computes with.
local crc_table = {}
for n = 0, 255 do
  local c = n
  for _ = 1, 8 do
    local odd = bit.band(c, 1) == 1
    c = bit.rshift(c, 1)
    if odd then c = bit.bxor(c, 0xEDB88320) end
  end
  crc_table[n] = c
end

local function crc32(bytes)
  local c = bit.bnot(0)
  for i = 0, bytes:len() - 1 do
    c = bit.bxor(bit.rshift(c, 8), crc_table[bit.band(bit.bxor(c, bytes:get_index(i)), 0xFF)])
  end
  return bit.bnot(c)
end

-- Names of nodes, as far as the interfaces ("left_hip -> left_knee") of packets seen so far tell.
local names = {}

local function name_of(id)
  if names[id] then return names[id] end
  return "node " .. id
end

local function learn_names(from, to)
  local interface = interface_name()
  local before, behind = string.match(interface and tostring(interface.value) or "", "^(%S+) %-> (%S+)$")
  if before then names[from], names[to] = before, behind end
end

local function dissect_pseudo_header(buffer, tree)
  local pseudo = tree:add(ring, buffer(0, PSEUDO_SIZE), "Seen on a line")
  pseudo:add(f["capture.version"], buffer(0, 1))
  for _, name in ipairs({"crc_bad", "aborted", "truncated", "embedded", "retry", "own", "input", "event"}) do
    pseudo:add(f["capture." .. name], buffer(1, 1))
  end
  pseudo:add(f["capture.from"], buffer(2, 1))
  pseudo:add(f["capture.to"], buffer(3, 1))
  pseudo:add(f["capture.span"], buffer(4, 4))
  local flags = buffer(1, 1):uint()
  if bit.band(flags, 0x08) ~= 0 then
    pseudo:add(f["carrier.sid"], buffer(8, 1)):add_proto_expert_info(e.embedded)
    pseudo:add(f["carrier.code"], buffer(9, 1))
    pseudo:add(f["carrier.offset"], buffer(10, 2))
  end
  if bit.band(flags, 0x06) ~= 0 then pseudo:add_proto_expert_info(e.cut) end
  return flags
end

local function dissect_header(packet, tree)
  local code = tree:add(f["code"], packet(0, 1))
  for _, name in ipairs({"incarnation", "kind", "try", "seq"}) do code:add(f[name], packet(0, 1)) end
  if bit.band(packet(0, 1):uint(), 0x18) ~= 0 then code:add_proto_expert_info(e.retry) end
  tree:add(f["sop"], packet(1, 1))
  tree:add(f["hop"], packet(2, 1))
  tree:add(f["sid"], packet(3, 1)):append_text(" (" .. name_of(packet(3, 1):uint()) .. ")")
end

local function dissect_control(data, tree)
  local kind = data(0, 1):uint()
  if not control_sizes[kind] or not control_sizes[kind][data:len()] then return nil end
  tree:add(f["control"], data(0, 1))
  local words, at = control_types[kind], 1
  for _, one in ipairs(control_fields[kind]) do
    local name, size = one[1], one[2]
    if at + size > data:len() then break end
    tree:add(f[name], data(at, size))
    if name == "beacon.cpu_state" then words = words .. ", CPU " .. (cpu_states[data(at, size):uint()] or "?") end
    at = at + size
  end
  return words
end

local function dissect_joints(data, tree)
  local head, each = 16, 12
  if data:len() < head or data(0, 1):uint() ~= 1 then return nil end
  local count = data(13, 1):uint()
  if data:len() ~= head + count * each then return nil end
  tree:add(f["joint.sequence"], data(2, 2))
  for i = 0, count - 1 do
    local at = head + i * each
    local joint = tree:add(ring, data(at, each), "Joint " .. i)
    for k, name in ipairs({"position", "velocity", "effort"}) do
      local value = data(at + 4 * (k - 1), 4)
      joint:add(f["joint." .. name], value, value:int() / 1e6)
    end
  end
  return "joint state " .. data(2, 2):uint()
end

local function dissect_data(data, channel, tree)
  local item = tree:add(f["data"], data())
  if channel == CONTROL then return dissect_control(data, item) end
  if channel == JOINT then return dissect_joints(data, item) end
  return nil
end

local function dissect_trailer(packet, interrupt, tree)
  local at = packet:len() - TRAILER - CRC
  tree:add(f["eop"], packet(at, 1))
  local fbc = tree:add(f["fbc"], packet(at + 1, 1))
  local free = packet(at + 1, 1):uint()
  if free == UNTAKEN then fbc:append_text(" (nobody has taken it)") end
  if free == 0 then fbc:add_proto_expert_info(e.refused) end
  local to = packet(at + 2, 1):uint()
  tree:add(f["did"], packet(at + 2, 1)):append_text(" (" .. (to == BROADCAST and "all" or name_of(to)) .. ")")
  if interrupt then
    tree:add(f["int"], packet(at + 3, 1))
  else
    tree:add(f["channel"], packet(at + 3, 1))
    tree:add(f["pri"], packet(at + 3, 1))
  end
end

local function dissect_crc(packet, tree)
  local at = packet:len() - CRC
  local good = crc32(packet(0, at):bytes()) == bit.tobit(packet(at, CRC):uint())
  local item = tree:add(f["crc"], packet(at, CRC))
  item:add(f["crc.status"], packet(at, CRC), good and 1 or 0):set_generated()
  if not good then item:add_proto_expert_info(e.crc) end
  return good
end

local function say(pinfo, packet, interrupt, words, good)
  local at = packet:len() - TRAILER - CRC
  local last = packet(at + 3, 1):uint()
  local to = packet(at + 2, 1):uint()
  pinfo.cols.dst = to == BROADCAST and "all" or name_of(to)
  local what = "INT" .. last
  if not interrupt then
    local channel = bit.rshift(last, 2)
    what = string.format("p%d %s, %d bytes", bit.band(last, 3), channels[channel] or ("channel " .. channel),
                         packet:len() - OVERHEAD)
  end
  local code = packet(0, 1):uint()
  local info = string.format("%s hop %d, fbc %d, try %d seq %d, %s%s", interrupt and "INTP" or "DATP",
                             packet(2, 1):uint(), packet(at + 1, 1):uint(), bit.rshift(bit.band(code, 0x18), 3),
                             bit.band(code, 7), what, words and (": " .. words) or "")
  pinfo.cols.info = info .. (good and "" or " [CRC bad]")
end

local function dissect_packet(packet, flags, pinfo, tree)
  local interrupt = bit.band(packet(0, 1):uint(), 0x20) ~= 0
  pinfo.cols.src = name_of(packet(3, 1):uint())
  dissect_header(packet, tree)
  if bit.band(flags, 0x06) ~= 0 or packet:len() < OVERHEAD then
    if packet:len() > HEADER then tree:add(f["data"], packet(HEADER)) end
    pinfo.cols.info = (interrupt and "INTP" or "DATP") .. " cut off after " .. packet:len() .. " bytes"
    return
  end
  local words
  local size = packet:len() - OVERHEAD
  local channel = bit.rshift(packet(packet:len() - CRC - 1, 1):uint(), 2)
  if size > 0 then words = dissect_data(packet(HEADER, size):tvb(), channel, tree) end
  dissect_trailer(packet, interrupt, tree)
  local good = dissect_crc(packet, tree)
  say(pinfo, packet, interrupt, words, good)
  if bit.band(flags, 0x08) ~= 0 then pinfo.cols.info:append(" [inside a DATP]") end
end

-- USER0 is everybody's: what does not look like ours is left to others.
local function is_ours(buffer)
  if buffer:len() < PSEUDO_SIZE or buffer(0, 1):uint() ~= 1 then return false end
  local flags = buffer(1, 1):uint()
  if bit.band(flags, 0x80) ~= 0 then return true end
  if buffer:len() < PSEUDO_SIZE + HEADER then return false end
  return bit.band(flags, 0x01) ~= 0 or buffer(PSEUDO_SIZE + 1, 1):uint() == START
end

function ring.dissector(buffer, pinfo, root)
  if not is_ours(buffer) then return 0 end
  pinfo.cols.protocol = "LimbRing"
  local from, to = buffer(2, 1):uint(), buffer(3, 1):uint()
  learn_names(from, to)
  local tree = root:add(ring, buffer())
  local flags = dissect_pseudo_header(buffer, tree)
  if bit.band(flags, 0x80) ~= 0 then
    local comment = frame_comment()
    local what = comment and tostring(comment.value) or ""
    tree:add(f["event"], what)
    pinfo.cols.src = name_of(from)
    pinfo.cols.info = "* " .. what
  elseif buffer:len() >= PSEUDO_SIZE + HEADER then
    dissect_packet(buffer(PSEUDO_SIZE):tvb(), flags, pinfo, tree)
  end
  return buffer:len()
end

DissectorTable.get("wtap_encap"):add(wtap.USER0, ring)
