#include "support/command.hpp"

#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace corda::test {

namespace fs = std::filesystem;

std::string quoted(const std::string& text) {
    std::string result = "'";
    for (const char c : text) {
        if (c == '\'') result += "'\\'";
        result += c;
    }
    result += '\'';
    return result;
}

CommandResult run_shell(const std::string& command) {
    const ScratchFolder scratch;
    const std::string script = scratch.write("script", command + "\n");
    const std::string line = "bash " + quoted(script) + " > " + quoted(scratch.file("out")) + " 2> " +
                             quoted(scratch.file("err")) + " < /dev/null";
    const int status = std::system(line.c_str());
    CommandResult result;
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    result.out = read_file(scratch.file("out"));
    result.err = read_file(scratch.file("err"));
    return result;
}

std::string wait_until(const std::string& condition) {
    return "while kill -0 $pid 2>/dev/null && ! " + condition + " >/dev/null 2>&1; do sleep 0.01; done; ";
}

std::string wait_until_listening() {
    // Signal 2 is the second bit in the last digit of the mask.
    return wait_until("grep '^SigCgt:.*[2367abef]$' /proc/$pid/status");
}

CommandResult run_corda(const std::vector<std::string>& arguments, const std::string& environment) {
    std::string command = environment + " " + quoted(CORDA_PROGRAM);
    for (const std::string& argument : arguments) command += " " + quoted(argument);
    return run_shell(command);
}

ScratchFolder::ScratchFolder() {
    std::string pattern = (fs::temp_directory_path() / "corda-test-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
}

ScratchFolder::~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

std::string ScratchFolder::write(const std::string& name, const std::string& text) const {
    write_file(file(name), text);
    return file(name);
}

std::vector<std::string> ScratchFolder::files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(path_)) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

void write_file(const std::string& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

std::string read_file(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace corda::test
