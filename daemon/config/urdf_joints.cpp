#include "config/urdf_joints.h"

#include <tinyxml2.h>

#include "config/config_error.h"

namespace limb_ring::config {
namespace {

using tinyxml2::XMLElement;

class UrdfReader {
 public:
  explicit UrdfReader(UrdfJoints& into) : urdf_(into) {}

  void read(const std::string& text) {
    tinyxml2::XMLDocument xml;
    if (xml.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
      refuse(xml.ErrorLineNum(), std::string("is not XML: ") + xml.ErrorName());
    const XMLElement* root = xml.RootElement();
    if (!root) refuse(1, "holds no XML element; allowed: <robot>");
    if (root->Name() != std::string("robot"))
      refuse(root->GetLineNum(), std::string("is no URDF: its root is <") + root->Name() + ">; allowed: <robot>");
    for (const XMLElement* joint = root->FirstChildElement("joint"); joint; joint = joint->NextSiblingElement("joint"))
      take(*joint);
  }

 private:
  void take(const XMLElement& element) {
    const std::string name = text_of(element.Attribute("name"));
    if (name.empty()) refuse(element.GetLineNum(), "a joint has no name");
    UrdfJoint joint;
    joint.line = element.GetLineNum();
    joint.type = text_of(element.Attribute("type"));
    if (const XMLElement* limit = element.FirstChildElement("limit")) {
      joint.has_limit = true;
      for (const auto* one = limit->FirstAttribute(); one; one = one->Next()) joint.limit[one->Name()] = one->Value();
    }
    if (!urdf_.joints.emplace(name, joint).second)
      refuse(joint.line,
             "joint '" + name + "' is there twice, first in line " + std::to_string(urdf_.joints[name].line));
  }

  static std::string text_of(const char* attribute) { return attribute ? attribute : ""; }

  [[noreturn]] void refuse(int line, const std::string& problem) const {
    throw ConfigError(urdf_.path + ':' + std::to_string(line) + ": " + problem);
  }

  UrdfJoints& urdf_;
};

}  // namespace

UrdfJoints parse_urdf(const std::string& text, const std::string& path) {
  UrdfJoints urdf;
  urdf.path = path;
  UrdfReader(urdf).read(text);
  return urdf;
}

}  // namespace limb_ring::config
