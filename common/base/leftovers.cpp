#include "common/base/leftovers.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>

namespace shadowcache {

namespace {

namespace fs = std::filesystem;

/// Without what a file's name cannot hold, or what separates the parts of a run's name.
std::string plain(std::string text, const char* allowed) {
    for (char& c : text)
        if (!std::isalnum(static_cast<unsigned char>(c)) && std::strchr(allowed, c) == nullptr)
            c = '_';
    return text.substr(0, 64);
}

std::string hostName() {
    char name[256] = "";
    if (gethostname(name, sizeof name - 1) != 0) return "unknown";
    return plain(name, ".-");
}

/// Longest name of a file whose temporary names begin with all of it; file systems have 255 bytes.
constexpr std::size_t kLongestStem = 100;

/// What the temporary names of a file begin with.
std::string temporaryStem(const fs::path& path) {
    const std::string name = path.filename().string();
    if (name.size() <= kLongestStem) return name;
    std::uint64_t hash = 0xcbf29ce484222325;  // FNV-1a
    for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
    const std::string end = fmt::format("~{:016x}", hash);
    return name.substr(0, kLongestStem - end.size()) + end;
}

/// Removes a file unless a process, of whatever container, has it locked.
bool removeUnlocked(const fs::path& path) {
    int file = open(path.c_str(), O_RDWR | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC);
    if (file < 0) file = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC);
    const bool locked = file >= 0 && flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    std::error_code error;
    const bool removed = !locked && fs::remove(path, error);
    if (file >= 0) close(file);
    return removed;
}

std::string jobName() {
    for (const char* variable : {"SLURM_JOB_ID", "PBS_JOBID", "LSB_JOBID", "JOB_ID"})
        if (const char* job = std::getenv(variable); job && *job) return plain(job, ".");
    return "nojob";
}

}  // namespace

const std::string& runName() {
    static const std::string name = fmt::format("{}-{}-{}", getpid(), jobName(), hostName());
    return name;
}

fs::path temporaryPath(const fs::path& path) {
    std::random_device random;
    return path.parent_path() /
           fmt::format("{}{}{}~{:08x}", temporaryStem(path), kTemporaryMark, runName(), random());
}

bool mayBeAlive(const std::string& run) {
    int pid = 0;
    const auto parsed = std::from_chars(run.data(), run.data() + run.size(), pid);
    const std::size_t host = run.find('-', run.find('-') + 1);
    if (parsed.ec != std::errc() || pid <= 0 || host == std::string::npos) return true;
    if (run.substr(host + 1, run.find('~') - host - 1) != hostName()) return true;
    return kill(pid, 0) == 0 || errno == EPERM;
}

std::vector<Leftover> removeLeftovers(const fs::path& path, std::vector<Leftover>& kept) {
    std::vector<Leftover> removed;
    const std::string prefix = temporaryStem(path) + kTemporaryMark;
    std::error_code error;
    fs::directory_iterator entry(path.has_parent_path() ? path.parent_path() : ".", error);
    for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
        const std::string name = entry->path().filename().string();
        if (!name.starts_with(prefix)) continue;
        const Leftover found{entry->path(), name.substr(prefix.size())};
        // Of this process's number may also be one that has ended.
        const bool ours = found.run.substr(0, found.run.find('~')) == runName();
        const bool gone = (ours || !mayBeAlive(found.run)) && removeUnlocked(found.path);
        if (gone || !ours) (gone ? removed : kept).push_back(found);
    }
    const auto byPath = [](const Leftover& a, const Leftover& b) { return a.path < b.path; };
    std::ranges::sort(removed, byPath);
    std::ranges::sort(kept, byPath);
    return removed;
}

void reportLeftovers(const fs::path& path) {
    std::vector<Leftover> kept;
    for (const Leftover& left : removeLeftovers(path, kept))
        std::printf("%s: removed, left by a run that has ended\n", left.path.c_str());
    for (const Leftover& left : kept)
        std::printf("%s: kept, of another run that may go on; remove it if it has ended\n",
                    left.path.c_str());
}

}  // namespace shadowcache
