// Loads each scene whose path stands on a line of standard input, and says what Etalon thinks of it, a line for each
// thought: "ok", "refused", "warning", then the path, the JSON pointer and the words, with tabs between them.
#include <cstdio>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/error.h"
#include "engine/scene/load.h"

namespace {

/// Tabs and line ends part the fields.
std::string field(std::string text)
{
    for (char& c : text)
        if (c == '\n' || c == '\t') c = ' ';
    return text;
}

void say(std::string_view verdict, const std::string& path, const std::string& pointer, const std::string& words)
{
    std::printf("%s\t%s\t%s\t%s\n", std::string(verdict).c_str(), path.c_str(), field(pointer).c_str(),
                field(words).c_str());
}

void judge(const std::string& path)
{
    try {
        const etalon::Scene scene = etalon::load_scene(path);
        std::vector<std::string> warnings = scene.warnings;
        warnings.insert(warnings.end(), scene.broken_rules.begin(), scene.broken_rules.end());
        for (const std::string& warning : warnings) {
            // A warning begins with its pointer.
            const std::size_t colon = warning.starts_with('/') ? warning.find(':') : std::string::npos;
            say("warning", path, colon == std::string::npos ? "" : warning.substr(0, colon), warning);
        }
        say("ok", path, "", "");
    } catch (const etalon::Error& error) {
        const std::string pointer = error.where().empty() ? "" : error.where().front();
        say("refused", path, pointer == path ? "" : pointer, error.what());
    }
    std::fflush(stdout);
}

}  // namespace

int main()
{
    for (std::string path; std::getline(std::cin, path);) judge(path);
}
