#include "tests/support/program_run.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <grp.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <map>
#include <sstream>
#include <thread>

#include "common/base/error.h"
#include "common/base/process.h"

namespace shadowcache::test {

const std::string& programPath(const std::string& name) {
    static const std::map<std::string, std::string> paths{
        {"bake", SHADOWCACHE_BAKE},
        {"render", SHADOWCACHE_RENDER},
        {"farm", SHADOWCACHE_FARM},
        {"info", SHADOWCACHE_INFO},
        {"merge", SHADOWCACHE_MERGE},
        {"make-set", SHADOWCACHE_MAKE_SET},
        {"path-tracer", SHADOWCACHE_PATH_TRACER},
    };
    return paths.at(name);
}

namespace {

/// What can be read from a pipe until its last writer is gone.
std::string drain(int pipe) {
    std::string text;
    char buffer[4096];
    while (true) {
        const ssize_t count = read(pipe, buffer, sizeof buffer);
        if (count <= 0) break;
        text.append(buffer, static_cast<std::size_t>(count));
    }
    close(pipe);
    return text;
}

[[noreturn]] void becomeProgram(const std::string& path, std::vector<std::string> arguments,
                                const std::filesystem::path& folder, const RunLimits& limits) {
    if (chdir(folder.c_str()) != 0) _exit(126);
    if (!limits.input.empty()) {
        const int input = open(limits.input.c_str(), O_RDONLY | O_CLOEXEC);
        if (input < 0 || dup2(input, STDIN_FILENO) < 0) _exit(126);
    }
    if (limits.fileBytes) {
        signal(SIGXFSZ, SIG_DFL);  // whoever runs the tests may ignore it
        const rlimit size{*limits.fileBytes, *limits.fileBytes};
        setrlimit(RLIMIT_FSIZE, &size);
    }
    constexpr id_t kNobody = 65534;
    if (limits.nobody && geteuid() == 0 &&
        (setgroups(0, nullptr) != 0 || setgid(kNobody) != 0 || setuid(kNobody) != 0))
        _exit(126);
    std::vector<char*> argv{const_cast<char*>(path.c_str())};
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    execv(path.c_str(), argv.data());
    _exit(127);
}

/// Waits until the process catches Ctrl-C, as the programs do before their work; ten seconds at
/// most.
void awaitHandler(pid_t process) {
    const std::string path = fmt::format("/proc/{}/status", process);
    for (int i = 0; i < 1000; ++i) {
        std::ifstream status(path);
        for (std::string line; std::getline(status, line);)
            if (line.starts_with("SigCgt:") &&
                (std::stoull(line.substr(7), nullptr, 16) & (1u << (SIGINT - 1))) != 0)
                return;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
}

/// Whether a child is over; it stays to be waited for.
bool hasEnded(pid_t process) {
    siginfo_t information{};
    waitid(P_PID, static_cast<id_t>(process), &information, WEXITED | WNOHANG | WNOWAIT);
    return information.si_pid == process;
}

}  // namespace

std::function<bool()> afterSeconds(double seconds) {
    return [seconds, first = std::optional<double>()]() mutable {
        if (!first) first = secondsNow();
        return secondsNow() - *first >= seconds;
    };
}

std::string programFolders() {
    std::string folders;
    for (const char* name : {"bake", "render"})
        folders += (folders.empty() ? "" : ":") +
                   std::filesystem::path(programPath(name)).parent_path().string();
    return folders;
}

ProgramRun runProgram(const std::string& name, const std::vector<std::string>& typed,
                      const std::filesystem::path& folder, const RunLimits& limits) {
    std::vector<std::string> arguments = typed;
    const bool says = std::ranges::any_of(typed, [](const std::string& word) {
        return word.starts_with("--bounces") || word == "--mix";
    });
    if (name == "render" && !says && !limits.standardBounces)
        arguments.insert(arguments.begin(), {"--bounces", "0"});
    int out[2], err[2];
    if (pipe2(out, O_CLOEXEC) != 0 || pipe2(err, O_CLOEXEC) != 0) throw Error("no pipe");
    const pid_t child = fork();
    if (child == 0) {
        dup2(out[1], STDOUT_FILENO);
        dup2(err[1], STDERR_FILENO);
        becomeProgram(programPath(name), arguments, folder, limits);
    }
    close(out[1]);
    close(err[1]);
    if (limits.interruptWhen) {
        awaitHandler(child);
        while (!limits.interruptWhen() && !hasEnded(child))
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        kill(child, limits.signal);
    }
    ProgramRun run;
    run.out = drain(out[0]);
    run.err = drain(err[0]);
    int status = 0;
    waitpid(child, &status, 0);
    run.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return run;
}

bool runAndKill(const std::string& name, const std::vector<std::string>& arguments,
                const std::filesystem::path& folder, double seconds) {
    const pid_t child = fork();
    if (child == 0) {
        const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
        dup2(nowhere, STDOUT_FILENO);
        dup2(nowhere, STDERR_FILENO);
        becomeProgram(programPath(name), arguments, folder, {});
    }
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    return WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
}

std::vector<std::string> filesIn(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        names.push_back(entry.path().lexically_relative(folder).string());
    std::sort(names.begin(), names.end());
    return names;
}

std::vector<std::string> words(const std::string& line) {
    std::istringstream stream(line);
    return {std::istream_iterator<std::string>(stream), {}};
}

void expectRefusal(const ProgramRun& run, const std::string& program, const std::string& first,
                   const std::string& second, int status) {
    EXPECT_EQ(run.status, status) << run.err;
    EXPECT_EQ(run.err.rfind("shadowcache-" + program + ": ", 0), 0u) << run.err;
    EXPECT_NE(run.err.find(first), std::string::npos) << first << " in: " << run.err;
    EXPECT_NE(run.err.find(second), std::string::npos) << second << " in: " << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
}

}  // namespace shadowcache::test
