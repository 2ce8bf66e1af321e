// Loops visit every index once; sums have the same bits; errors and Ctrl-C end them; calls at
// once have their own numbers of threads.

#include "common/base/parallel.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "common/base/call_threads.h"
#include "common/base/error.h"
#include "common/base/exit_status.h"
#include "common/base/progress.h"

namespace shadowcache {
namespace {

/// Puts the number of threads back when a test ends.
class Parallel : public testing::Test {
protected:
    ~Parallel() override { setThreadCount(0); }
};

double harmonicSum() {
    return parallelSum(1000003, 1000, [](const Chunk& chunk) {
        double sum = 0.0;
        for (std::size_t i = chunk.begin; i < chunk.end; ++i)
            sum += std::sin(static_cast<double>(i)) / (1.0 + static_cast<double>(i));
        return sum;
    });
}

TEST_F(Parallel, VisitsEveryIndexOnce) {
    for (const std::size_t count : {0u, 1u, 7u, 8u, 9u, 1000u}) {
        for (const std::size_t chunkSize : {1u, 8u, 5000u}) {
            std::vector<std::atomic<int>> visits(count);
            parallelFor(count, chunkSize, [&](const Chunk& chunk) {
                EXPECT_EQ(chunk.begin, chunk.index * chunkSize);
                EXPECT_LT(chunk.begin, chunk.end);
                EXPECT_LE(chunk.end - chunk.begin, chunkSize);
                for (std::size_t i = chunk.begin; i < chunk.end; ++i) ++visits[i];
            });
            for (const auto& visit : visits) EXPECT_EQ(visit, 1);
        }
    }
}

TEST_F(Parallel, LimitsTheThreads) {
    const int cores = threadCount();
    EXPECT_GE(cores, 1);
    setThreadCount(1);
    EXPECT_EQ(threadCount(), 1);
    const std::thread::id self = std::this_thread::get_id();
    parallelFor(100, 1, [&](const Chunk&) { EXPECT_EQ(std::this_thread::get_id(), self); });
    setThreadCount(0);
    EXPECT_EQ(threadCount(), cores);
}

/// Threads that a call with so many at most works on.
std::set<std::thread::id> threadsOf(int threads) {
    std::set<std::thread::id> ids;
    std::mutex mutex;
    withThreads(threads, [&] {
        parallelFor(200, 1, [&](const Chunk&) {
            EXPECT_LE(threadCount(), threads);
            // A loop in a loop is of the call, too.
            parallelFor(2, 1, [&](const Chunk&) {
                EXPECT_LE(threadCount(), threads);
                std::this_thread::sleep_for(std::chrono::microseconds(100));
                const std::lock_guard lock(mutex);
                ids.insert(std::this_thread::get_id());
            });
        });
    });
    return ids;
}

TEST_F(Parallel, CallsHaveTheirOwnNumbersOfThreads) {
    const int cores = threadCount();
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(harmonicSum());
    std::set<std::thread::id> one, two;
    double sums[2] = {};
    {
        const std::jthread first([&] {
            one = threadsOf(1);
            withThreads(1, [&] { sums[0] = harmonicSum(); });
        });
        const std::jthread second([&] {
            for (int i = 0; i < 100 && two.size() < 2; ++i) two = threadsOf(2);
            withThreads(2, [&] { sums[1] = harmonicSum(); });
        });
    }
    EXPECT_EQ(one.size(), 1u);
    if (cores > 1) {
        EXPECT_GE(two.size(), 2u);
    }
    for (const double sum : sums) EXPECT_EQ(std::bit_cast<std::uint64_t>(sum), bits);
    EXPECT_EQ(threadCount(), cores);
}

TEST_F(Parallel, ACallWithFewThreadsEndsWithIt) {
    const int cores = threadCount();
    EXPECT_THROW(withThreads(1,
                             [] {
                                 EXPECT_EQ(threadCount(), 1);
                                 throw Error("no");
                             }),
                 Error);
    EXPECT_EQ(threadCount(), cores);
    withThreads(0, [&] { EXPECT_EQ(threadCount(), cores); });
    setThreadCount(1);
    withThreads(8, [] { EXPECT_EQ(threadCount(), 1); });
}

TEST_F(Parallel, SumsToTheSameBitsForAnyNumberOfThreads) {
    setThreadCount(1);
    const double one = harmonicSum();
    EXPECT_NE(one, 0.0);
    for (const int threads : {0, 2, 3, 8}) {
        setThreadCount(threads);
        for (int run = 0; run < 10; ++run)
            EXPECT_EQ(std::bit_cast<std::uint64_t>(harmonicSum()),
                      std::bit_cast<std::uint64_t>(one));
    }
}

TEST_F(Parallel, SumOfNothingIsZero) {
    EXPECT_EQ(parallelSum(0, 10, [](const Chunk&) { return 1.0; }), 0.0);
}

TEST_F(Parallel, RethrowsAndStops) {
    for (const int threads : {1, 0}) {
        setThreadCount(threads);
        std::atomic<int> runs{0};
        try {
            parallelFor(1000000, 1, [&](const Chunk& chunk) {
                ++runs;
                if (chunk.index == 17) throw Error("chunk 17");
            });
            ADD_FAILURE() << "no exception";
        } catch (const Error& e) {
            EXPECT_STREQ(e.what(), "chunk 17");
        }
        EXPECT_LT(runs, 1000000);
    }
    // The next loop is not harmed.
    EXPECT_EQ(parallelSum(10, 1, [](const Chunk&) { return 1.0; }), 10.0);
}

TEST_F(Parallel, Nests) {
    const double sum = parallelSum(20, 3, [](const Chunk& outer) {
        return static_cast<double>(outer.end - outer.begin) *
               parallelSum(50, 4, [](const Chunk& inner) {
                   return static_cast<double>(inner.end - inner.begin);
               });
    });
    EXPECT_EQ(sum, 1000.0);
}

/// What four equal pieces of work print.
std::string progressOfFour() {
    testing::internal::CaptureStderr();
    {
        Progress progress("bake", 8);
        for (int i = 0; i < 4; ++i) progress.add(2);
    }
    return testing::internal::GetCapturedStderr();
}

class ProgressStyles : public testing::Test {
protected:
    ~ProgressStyles() override { setProgressStyle(ProgressStyle::none); }
};

TEST_F(ProgressStyles, OfShortWorkIsSilentInAPipe) {
    setProgressStyle(standardProgressStyle());
    EXPECT_EQ(progressOfFour(), "");
}

TEST_F(ProgressStyles, LinesAreWhole) {
    setProgressStyle(ProgressStyle::lines, 0);
    EXPECT_EQ(progressOfFour(),
              "bake: 25 %, 0 s left\nbake: 50 %, 0 s left\nbake: 75 %, 0 s left\n"
              "bake: 100 %, 0 s left\n");
}

TEST_F(ProgressStyles, JsonHasTheEndOfShortWork) {
    setProgressStyle(ProgressStyle::json);
    EXPECT_EQ(progressOfFour(),
              "{\"task\":\"bake\",\"done\":8,\"total\":8,\"seconds\":0.0,\"left\":0.0}\n");
}

TEST_F(ProgressStyles, BarLeavesNothing) {
    setProgressStyle(ProgressStyle::bar, 0);
    EXPECT_TRUE(progressOfFour().ends_with("\r\033[K"));
    setProgressStyle(ProgressStyle::none, 0);
    EXPECT_EQ(progressOfFour(), "");
}

/// Ends the process with 3 if a parallel loop is left by the interrupt.
[[noreturn]] void loopUntilInterrupted(int signal) {
    installInterruptHandler();
    throwIfInterrupted();
    try {
        parallelFor(100, 1, [&](const Chunk& chunk) {
            if (chunk.index == 50) std::raise(signal);
            throwIfInterrupted();
        });
    } catch (const Error& e) {
        std::exit(std::string(e.what()) == "interrupted" ? 3 : 4);
    }
    std::exit(5);
}

TEST(InterruptDeathTest, EndsALoopCleanly) {
    testing::FLAGS_gtest_death_test_style = "threadsafe";
    EXPECT_EXIT(loopUntilInterrupted(SIGINT), testing::ExitedWithCode(3), "");
    EXPECT_EXIT(loopUntilInterrupted(SIGTERM), testing::ExitedWithCode(3), "");
}

// Reading a set and building its acceleration structure are not loops of ours.
TEST(InterruptDeathTest, EndsWorkThatDoesNotListen) {
    testing::FLAGS_gtest_death_test_style = "threadsafe";
    const auto deaf = [] {
        installInterruptHandler();
        std::raise(SIGTERM);
        for (int i = 0; i < 10; ++i) sleep(1);  // a signal ends a sleep
        std::exit(3);
    };
    EXPECT_EXIT(deaf(), testing::ExitedWithCode(kTryAgain), ": interrupted\n");
}

TEST(InterruptDeathTest, KillsAtTheSecondSignal) {
    testing::FLAGS_gtest_death_test_style = "threadsafe";
    const auto twice = [] {
        installInterruptHandler();
        std::raise(SIGINT);
        std::raise(SIGTERM);
    };
    EXPECT_EXIT(twice(), testing::KilledBySignal(SIGTERM), "");
}

}  // namespace
}  // namespace shadowcache
