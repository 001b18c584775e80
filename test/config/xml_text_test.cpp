// Any bytes become text that an XML parser takes.
#include "config/urdf_joints.h"

#include <gtest/gtest.h>

namespace limb_ring::config {
namespace {

constexpr const char* kReplaced = "\xEF\xBF\xBD";  // U+FFFD

TEST(XmlText, EscapesTheSpecialCharactersOfXml) {
  EXPECT_EQ(xml_text("a < b && \"c\" > d\n"), "a &lt; b &amp;&amp; &quot;c&quot; &gt; d\n");
}

TEST(XmlText, LeavesLettersOfAllLanguagesAsTheyAre) {
  EXPECT_EQ(xml_text("Hüfte 膝 \xF0\x9F\xA6\xBF"), "Hüfte 膝 \xF0\x9F\xA6\xBF");
}

TEST(XmlText, ReplacesControlCharactersThatXmlForbids) {
  EXPECT_EQ(xml_text("a\x1B[31mb"), std::string("a") + kReplaced + "[31mb");
  EXPECT_EQ(xml_text(std::string(1, '\0')), kReplaced);
  EXPECT_EQ(xml_text("\xEF\xBF\xBF").find("\xEF\xBF\xBF"), std::string::npos) << "U+FFFF";
  EXPECT_EQ(xml_text("\t\n"), "\t\n");
}

TEST(XmlText, ReplacesOnlyBytesThatAreNotUtf8) {
  EXPECT_EQ(xml_text("a\xFF<"), std::string("a") + kReplaced + "&lt;");
  EXPECT_EQ(xml_text("a\xC3<"), std::string("a") + kReplaced + "&lt;");
  EXPECT_EQ(xml_text("\xE8\x86"), std::string(kReplaced) + kReplaced);
}

}  // namespace
}  // namespace limb_ring::config
