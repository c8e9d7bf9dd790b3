// SPDX-License-Identifier: Apache-2.0
// Acupoints and paths as a person says them.
#include <algorithm>
#include <map>

#include "tuina/telemetry/report/figures.hpp"

namespace tuina::telemetry::figures {

std::string capital(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z')
    text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

std::string spoken(const std::string& acupoint, const Language& say) {
  const auto whole = [&](std::string name) {
    std::replace(name.begin(), name.end(), '_', ' ');
    return name;
  };
  const std::string name = whole(acupoint.substr(0, acupoint.rfind('_')));
  if (acupoint.ends_with("_L")) return say("{} left", name);
  if (acupoint.ends_with("_R")) return say("{} right", name);
  return whole(acupoint);
}

std::string place_of(const ContactPath& path, const Language& say) {
  // The name says the technique first: "stroke bladder_inner_L".
  if (path.acupoints.empty()) return spoken(path.name.substr(path.name.find(' ') + 1), say);
  const std::string first = spoken(path.acupoints.front(), say);
  return path.acupoints.size() == 1 ? first
                                    : say("{} to {}", first, spoken(path.acupoints.back(), say));
}

std::string said_path(const ContactPath& path, const Language& say) {
  return say(name_of(path.technique)) + " " + place_of(path, say);
}

std::string chinese_name(const std::string& acupoint) {
  // WHO Standard Acupuncture Point Locations in the Western Pacific Region (2008).
  static const std::map<std::string, std::string> names = {
      {"SI11", "Tianzong"},   {"BL47", "Hunmen"}, {"BL50", "Weicang"}, {"GV4", "Mingmen"},
      {"BL13", "Feishu"},     {"BL15", "Xinshu"}, {"BL17", "Geshu"},   {"BL18", "Ganshu"},
      {"BL20", "Pishu"},      {"BL21", "Weishu"}, {"BL23", "Shenshu"}, {"GV2", "Yaoshu"},
      {"GV3", "Yaoyangguan"}, {"GV6", "Jizhong"}, {"GV9", "Zhiyang"},  {"GV12", "Shenzhu"},
      {"GV14", "Dazhui"}};
  const auto found = names.find(acupoint.substr(0, acupoint.find('_')));
  return found == names.end() ? "" : found->second;
}

}  // namespace tuina::telemetry::figures
