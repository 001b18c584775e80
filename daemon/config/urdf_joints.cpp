#include "config/urdf_joints.h"

#include <tinyxml2.h>

#include <boost/locale/utf.hpp>
#include <set>

#include "config/quantity.h"
#include "config/ring_config.h"

namespace limb_ring::config {
namespace {

using tinyxml2::XMLElement;

/// What else robots are described in, by the root element, and what makes a URDF of it.
std::string other_format(const std::string& root) {
  if (root == "sdf")
    return "is an SDF, Gazebo's format, not a URDF. 'rosrun pysdf sdf2urdf.py FILE.sdf robot.urdf' (package pysdf) "
           "converts it; most robots are also published as URDF";
  if (root == "mujoco") return "is a MuJoCo model (MJCF), not a URDF; most robots are also published as URDF";
  if (root == "COLLADA")
    return "is a COLLADA file, not a URDF. 'rosrun collada_urdf collada_to_urdf FILE.dae' (package collada_urdf) "
           "converts it";
  if (root == "launch")
    return "is a launch file, not a URDF. 'rosparam get /robot_description > robot.urdf' saves the URDF it loads";
  return "is not a URDF: its root is <" + root + ">; allowed: <robot>";
}

bool is_unexpanded(const std::string& text) {
  return text.find("${") != std::string::npos || text.find("$(") != std::string::npos;
}

/// The first element that xacro would replace; nullptr: there is none. Some URDFs still call macros that nobody
/// defines, of old Gazebo plug-ins.
const XMLElement* xacro_in(const XMLElement& root) {
  static const std::set<std::string> kinds{"xacro:include", "xacro:macro",  "xacro:property", "xacro:arg",
                                           "xacro:if",      "xacro:unless", "include",        "macro"};
  for (const XMLElement* part = root.FirstChildElement(); part; part = part->NextSiblingElement()) {
    if (kinds.count(part->Name()) != 0) return part;
    if (const char* name = part->Attribute("name"); name && is_unexpanded(name)) return part;
  }
  return nullptr;
}

/// XML's declaration may only stand at the very beginning. Old versions of xacro write comments before it, and ROS
/// takes that: it becomes blanks.
std::string without_late_declaration(std::string text) {
  const std::size_t begin = text.find("<?xml "), end = text.find("?>", begin);
  if (begin == 0 || end == std::string::npos) return text;
  return text.replace(begin, end + 2 - begin, end + 2 - begin, ' ');
}

class UrdfReader {
 public:
  UrdfReader(UrdfJoints& into, bool whole) : urdf_(into), whole_(whole) {}

  void read(const std::string& given) {
    const std::string text = without_late_declaration(given);
    tinyxml2::XMLDocument xml;
    if (xml.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
      refuse(xml.ErrorLineNum(), std::string("is not XML: ") + xml.ErrorName());
    const XMLElement* root = xml.RootElement();
    if (!root) refuse(1, "holds no XML element; allowed: <robot>");
    if (root->Name() != std::string("robot")) refuse(root->GetLineNum(), other_format(root->Name()));
    if (const XMLElement* part = xacro_in(*root))
      refuse(part->GetLineNum(), std::string("is a xacro file, which is not expanded yet: <") + part->Name() +
                                     ">. 'xacro FILE.xacro > robot.urdf' makes a URDF of it");
    urdf_.robot = text_of(root->Attribute("name"));
    for (const XMLElement* link = root->FirstChildElement("link"); link; link = link->NextSiblingElement("link"))
      if (!links_.insert(text_of(link->Attribute("name"))).second && whole_)
        problems_.gather(
            [&] { refuse(link->GetLineNum(), "link '" + text_of(link->Attribute("name")) + "' is there twice"); });
    for (const XMLElement* joint = root->FirstChildElement("joint"); joint; joint = joint->NextSiblingElement("joint"))
      problems_.gather([&] { take(*joint); });
    for (const auto& [name, joint] : urdf_.joints)
      if (joint.mimic) problems_.gather([&, &name = name, &joint = joint] { check_mimic(name, joint); });
    if (whole_) problems_.gather([&] { check_tree(root->GetLineNum()); });
    problems_.refuse_all();
  }

 private:
  void take(const XMLElement& element) {
    const std::string name = text_of(element.Attribute("name"));
    if (name.empty()) refuse(element.GetLineNum(), "a joint has no name");
    UrdfJoint joint;
    joint.line = element.GetLineNum();
    joint.type = text_of(element.Attribute("type"));
    joint.parent = link_of(element, "parent");
    joint.child = link_of(element, "child");
    if (const XMLElement* limit = element.FirstChildElement("limit")) {
      joint.has_limit = true;
      for (const auto* one = limit->FirstAttribute(); one; one = one->Next()) joint.limit[one->Name()] = one->Value();
    }
    if (const XMLElement* mimic = element.FirstChildElement("mimic"); mimic && joint.moves())
      joint.mimic = {text_of(mimic->Attribute("joint")), number(*mimic, "multiplier", 1), number(*mimic, "offset", 0)};
    problems_.gather([&] { check_type(name, joint); });
    if (whole_) check_whole(name, joint);
    if (!urdf_.joints.emplace(name, joint).second)
      refuse(joint.line,
             "joint '" + name + "' is there twice, first in line " + std::to_string(urdf_.joints[name].line));
    urdf_.order.push_back(name);
  }

  void check_type(const std::string& name, const UrdfJoint& joint) const {
    static const std::set<std::string> kTypes{"revolute", "continuous", "prismatic", "fixed", "floating", "planar"};
    if (kTypes.count(joint.type) == 0)
      refuse(joint.line, "joint '" + name + "' is " + (joint.type.empty() ? "of no type" : "'" + joint.type + "'") +
                             "; allowed: revolute, continuous, prismatic, fixed, floating, planar");
  }

  /// Where robot_state_publisher and others would refuse the robot.
  void check_whole(const std::string& name, const UrdfJoint& joint) {
    const auto note = [&](const std::string& problem) {
      problems_.gather([&] { refuse(joint.line, "joint '" + name + "' " + problem); });
    };
    for (const auto& [end, link] : {std::pair("parent", joint.parent), std::pair("child", joint.child)})
      if (link.empty())
        note(std::string("has no ") + end + "; allowed: <" + end + " link=\"LINK\"/>");
      else if (links_.count(link) == 0)
        note(std::string("has the ") + end + " '" + link + "'; there is no such <link>");
    if (!joint.moves()) return;
    for (const auto& [limit, written] : joint.limit)
      if (kLimits.count(limit) != 0 && !parse_real(written))
        note("has " + limit + "=\"" + written + "\"; allowed: a number such as -0.5");
    const double lower = limit_of(joint, "lower"), upper = limit_of(joint, "upper");
    if (joint.type != "continuous" && lower > upper)
      note("has the limits " + format_real(lower) + " to " + format_real(upper) + "; allowed: lower less than upper");
  }

  /// Every link but one is the child of a joint, and joints lead to it from that one.
  void check_tree(int line) const {
    std::multimap<std::string, const UrdfJoint*> below;  // joints by their parent
    std::set<std::string> roots = links_;
    for (const auto& [name, joint] : urdf_.joints) {
      if (links_.count(joint.parent) == 0 || links_.count(joint.child) == 0) return;  // said already
      below.emplace(joint.parent, &joint);
      roots.erase(joint.child);
    }
    if (roots.size() > 1)
      refuse(line, "no joint leads to the links " + join({roots.begin(), roots.end()}) +
                       "; allowed: one such link, from which joints lead to all others");
    std::vector<std::string> reached(roots.begin(), roots.end());
    for (std::size_t i = 0; i < reached.size(); ++i) {
      const auto [begin, end] = below.equal_range(std::string(reached[i]));
      for (auto joint = begin; joint != end; ++joint) reached.push_back(joint->second->child);
      below.erase(begin, end);
    }
    if (!below.empty())
      refuse(below.begin()->second->line,
             "link '" + below.begin()->first +
                 "' hangs in a loop of joints; allowed: joints that lead to it from a link "
                 "that is nobody's child");
  }

  /// 0 by default, says the format.
  static double limit_of(const UrdfJoint& joint, const char* limit) {
    const auto found = joint.limit.find(limit);
    return found == joint.limit.end() ? 0 : parse_real(found->second).value_or(0);
  }

  double number(const XMLElement& element, const char* name, double fallback) const {
    const char* written = element.Attribute(name);
    if (!written) return fallback;
    const auto value = parse_real(written);
    if (!value)
      refuse(element.GetLineNum(),
             std::string(name) + "=\"" + written + "\" of a <mimic> is not a number; allowed: such as -0.5");
    return *value;
  }

  /// At the end of the chain of joints that it follows is one with a motor.
  void check_mimic(const std::string& name, const UrdfJoint& joint) const {
    const UrdfJoint* leader = &joint;
    for (std::size_t steps = 0; leader->mimic; ++steps) {
      const auto found = urdf_.joints.find(leader->mimic->joint);
      if (found == urdf_.joints.end() || !found->second.moves())
        refuse(joint.line, "joint '" + name + "' mimics '" + leader->mimic->joint +
                               "', which is not a joint that moves; allowed: the name of one");
      if (steps == urdf_.joints.size())
        refuse(joint.line, "joint '" + name + "' mimics itself by way of others; allowed: a joint with a motor");
      leader = &found->second;
    }
  }

  static std::string text_of(const char* attribute) { return attribute ? attribute : ""; }
  static std::string link_of(const XMLElement& joint, const char* end) {
    const XMLElement* link = joint.FirstChildElement(end);
    return link ? text_of(link->Attribute("link")) : "";
  }

  [[noreturn]] void refuse(int line, const std::string& problem) const {
    throw ConfigError(urdf_.path + ':' + std::to_string(line) + ": " + problem);
  }

  inline static const std::set<std::string> kLimits{"lower", "upper", "velocity", "effort"};

  UrdfJoints& urdf_;
  bool whole_;
  std::set<std::string> links_;
  Problems problems_;
};

}  // namespace

UrdfJoint::Mimic UrdfJoints::leader_of(const std::string& joint) const {
  UrdfJoint::Mimic all = *joints.at(joint).mimic;
  while (const auto& next = joints.at(all.joint).mimic)
    all = {next->joint, all.multiplier * next->multiplier, all.multiplier * next->offset + all.offset};
  return all;
}

UrdfJoints parse_urdf(const std::string& text, const std::string& path, bool whole) {
  UrdfJoints urdf;
  urdf.path = path;
  UrdfReader(urdf, whole).read(text);
  return urdf;
}

namespace {

using boost::locale::utf::code_point;

constexpr const char* kReplacement = "\xEF\xBF\xBD";  // U+FFFD, in UTF-8

/// What XML 1.0 calls Char. (https://www.w3.org/TR/xml/#charsets)
bool is_allowed(code_point character) {
  if (character < ' ') return character == '\t' || character == '\n' || character == '\r';
  return boost::locale::utf::is_valid_codepoint(character) && character != 0xFFFE && character != 0xFFFF;
}

std::string escaped(const std::string& character) {
  if (character == "&") return "&amp;";
  if (character == "<") return "&lt;";
  if (character == ">") return "&gt;";
  if (character == "\"") return "&quot;";
  return character;
}

}  // namespace

std::string xml_text(const std::string& text) {
  std::string xml;
  for (auto at = text.begin(); at != text.end();) {
    const auto begin = at;
    if (is_allowed(boost::locale::utf::utf_traits<char>::decode(at, text.end()))) {
      xml += escaped({begin, at});
    } else {
      xml += kReplacement;
      at = begin + 1;  // what was read with it may be a character of its own
    }
  }
  return xml;
}

}  // namespace limb_ring::config
