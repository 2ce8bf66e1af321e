// Missing, empty, truncated, foreign, newer and altered files; full disks.

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <functional>
#include <random>

#include "common/image/exr.h"
#include "common/image/image.h"
#include "common/image/png.h"
#include "common/image/radiance.h"
#include "common/import/load_mesh.h"
#include "common/import/texture_decoder.h"
#include "common/mesh/mesh.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/loaded_mesh.h"
#include "tests/support/mesh_files.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

std::string squareExr() {
    const TemporaryFolder folder;
    const std::vector<float> values(64 * 32, 0.75f);
    writeExr(folder.path() / "a.exr", 64, 32, {{"R", values}, {"G", values}, {"B", values}}, {},
             PixelType::half);
    return readBytes(folder.path() / "a.exr");
}

/// A square with a texture, its mesh used twice and an animation beside.
std::string squareGlb() {
    const TemporaryFolder folder;
    writePng(folder.path() / "a.png", {2, 2, std::vector<Rgb>(4, Rgb(0.5f))}, 0);
    GltfBuilder file = squareGltf();
    const int view = file.view(readBytes(folder.path() / "a.png"));
    file.append("images", {{"bufferView", view}, {"mimeType", "image/png"}});
    file.append("textures", {{"source", 0}});
    file.append("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    file.json["meshes"][0]["primitives"][0]["material"] = 0;
    file.root({{"mesh", 0}});
    file.root({{"mesh", 0}, {"translation", {2, 0, 0}}});
    file.animate(file.root({{"name", "empty"}}), "translation", "LINEAR", {0, 1},
                 {0, 0, 0, 1, 0, 0});
    return file.glb();
}

std::string flatHdr() {
    return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n" + std::string(16, '\x81');
}

/// A good file of each kind, and how it is read.
struct Kind {
    std::string name;
    std::string bytes;
    std::function<void(const std::filesystem::path&)> read;
    /// Text formats without counts cannot tell every cut; whole lines or triangles may go.
    bool everyCutShows;
};

std::vector<Kind> kinds() {
    const auto mesh = [](const std::filesystem::path& path) { loadFile(path); };
    const auto image = [](const std::filesystem::path& path) { readRadiance(path); };
    return {{"a.obj", squareObj(), mesh, false},
            {"a.off", squareOff(), mesh, true},
            {"text.ply", squarePlyText(), mesh, true},
            {"binary.ply", squarePly(), mesh, true},
            {"binary.stl", squareStl(), mesh, true},
            {"text.stl", squareStlText(), mesh, false},
            {"a.glb", squareGlb(), mesh, true},
            {"one.om", squareOm(), mesh, true},
            {"two.om", squareAndTriangleOm2(), mesh, true},
            {"a.exr", squareExr(), image, true},
            {"a.hdr", flatHdr(), image, true}};
}

TEST(HostileInput, GoodFilesAreRead) {
    const TemporaryFolder folder;
    for (const Kind& kind : kinds()) {
        EXPECT_NO_THROW(kind.read(folder.write(kind.name, kind.bytes))) << kind.name;
    }
}

TEST(HostileInput, MissingEmptyAndDirectory) {
    const TemporaryFolder folder;
    for (const Kind& kind : kinds()) {
        const auto path = folder.path() / kind.name;
        expectError([&] { kind.read(path); }, path.string(), "no such file");
        folder.write(kind.name, "");
        expectError([&] { kind.read(path); }, path.string(), "is empty");
        std::filesystem::remove(path);
        std::filesystem::create_directory(path);
        expectError([&] { kind.read(path); }, path.string(), "is a directory");
        expectError([&] { kind.read(path / "in" / "it"); }, path.string(), "no such file");
        std::filesystem::remove(path);
    }
    expectError([] { loadFile("/dev/null"); }, "/dev/null", "expected an ordinary file");
    expectError([] { readRadiance("/dev/null"); }, "/dev/null", "expected an ordinary file");
}

TEST(HostileInput, CutOffFiles) {
    const TemporaryFolder folder;
    for (const Kind& kind : kinds()) {
        // The last byte of a text may be its last line break. Long files are cut in steps.
        for (std::size_t length = 1; length + 1 < kind.bytes.size(); ++length) {
            if (kind.bytes.size() > 100 && length % 7 != 0) continue;
            const auto path = folder.write(kind.name, kind.bytes.substr(0, length));
            try {
                kind.read(path);
                EXPECT_FALSE(kind.everyCutShows) << kind.name << " cut to " << length;
            } catch (const Error& e) {
                EXPECT_NE(std::string(e.what()).find(path.string()), std::string::npos) << e.what();
            }
        }
    }
}

TEST(HostileInput, CutOffTextsThatOnlyTheLastLineShows) {
    const TemporaryFolder folder;
    const std::string head = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    expectError([&] { loadFile(folder.write("a.obj", head + "f 1 2")); }, "a.obj",
                "line 5: file ends");
    expectError([&] { loadFile(folder.write("a.obj", head + "v 1 2\n")); }, "a.obj",
                "line 5: vertex with 2 numbers");
    expectError([&] { loadFile(folder.write("a.obj", "v 0 0 0\n")); }, "a.obj", "has no face");
}

TEST(HostileInput, ForeignFiles) {
    const TemporaryFolder folder;
    const auto all = kinds();
    for (const Kind& kind : all) {
        for (const Kind& other : all) {
            const bool isImage = kind.name == "a.exr" || kind.name == "a.hdr";
            const bool otherIsImage = other.name == "a.exr" || other.name == "a.hdr";
            const auto extension = [](const Kind& k) {
                return std::filesystem::path(k.name).extension();
            };
            if (extension(kind) == extension(other) || (isImage && otherIsImage)) continue;
            const auto path = folder.write(kind.name, other.bytes);
            expectError([&] { kind.read(path); }, path.string(), "");
        }
        const auto path = folder.write(kind.name, "\x89PNG\r\n\x1a\n" + std::string(200, '\0'));
        expectError([&] { kind.read(path); }, path.string(), "");
    }
    expectError([&] { loadFile(folder.write("a.fbx", "Kaydara")); }, "a.fbx",
                "extension '.fbx', expected one of .glb, .gltf, .obj, .off, .om, .ply, .stl");
}

TEST(HostileInput, NewerFiles) {
    const TemporaryFolder folder;
    std::string ply = squarePly();
    ply.replace(ply.find("1.0"), 3, "2.0");
    expectError([&] { loadFile(folder.write("a.ply", ply)); }, "a.ply",
                "version 2.0, expected 1.0");
    std::string om = squareOm();
    om[3] = '\x63';
    expectError([&] { loadFile(folder.write("a.om", om)); }, "a.om",
                "OM version 3.3, expected at most");
    std::string exr = squareExr();
    exr[4] = 3;
    expectError([&] { readRadiance(folder.write("a.exr", exr)); }, "a.exr",
                "OpenEXR version 3, expected at most 2");
    std::string hdr = flatHdr();
    hdr.replace(hdr.find("rgbe"), 4, "xyze");
    expectError([&] { readRadiance(folder.write("a.hdr", hdr)); }, "a.hdr",
                "expected FORMAT=32-bit_rle_rgbe");
    expectError([&] { loadFile(folder.write("a.off", "4OFF\n3 1 3\n")); }, "a.off",
                "'4OFF', expected");
}

/// Limits this test's memory, so that an allocation for a count that no file backs shows.
/// Sanitizers need all of the address space for themselves.
class MemoryLimit {
public:
    MemoryLimit() {
        getrlimit(RLIMIT_AS, &before_);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
        rlimit limit = before_;
        limit.rlim_cur = rlim_t{4} << 30;
        setrlimit(RLIMIT_AS, &limit);
#endif
    }
    ~MemoryLimit() {
        setrlimit(RLIMIT_AS, &before_);
    }

private:
    rlimit before_{};
};

TEST(HostileInput, CountsThatNoFileBacks) {
    const TemporaryFolder folder;
    const MemoryLimit limit;
    const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
        return text.replace(text.find(from), from.size(), to);
    };
    for (const std::string count : {"4000000000", "99999999999999999999", "-1"}) {
        for (const std::string& good : {squarePly(), squarePlyText()}) {
            for (const std::string element : {"vertex 4", "face 2"}) {
                const std::string name = element.substr(0, element.size() - 1);
                const auto path = folder.write("a.ply", replaced(good, element, name + count));
                expectError([&] { loadFile(path); }, "a.ply", "");
            }
        }
        for (const std::string& counts : {count + " 2", "4 " + count}) {
            const auto path = folder.write("a.off", replaced(squareOff(), "4 2", counts));
            expectError([&] { loadFile(path); }, "a.off", "");
        }
        const auto path = folder.write("b.hdr", replaced(flatHdr(), "+X 2", "+X " + count));
        expectError([&] { readRadiance(path); }, "b.hdr", "");
    }
    std::string list = replaced(squarePly(), "uchar int", "uint int");
    list[list.size() - 26] = '\xff';
    expectError([&] { loadFile(folder.write("a.ply", list)); }, "a.ply", "truncated");
    std::string stl = squareStl();
    stl[83] = '\x7f';
    expectError([&] { loadFile(folder.write("a.stl", stl)); }, "a.stl",
                "truncated, or neither STL text");
    std::string om = squareOm();
    om[7] = '\x7f';
    expectError([&] { loadFile(folder.write("a.om", om)); }, "a.om", "do not hold");
    std::string exr = squareExr();
    const std::size_t window = exr.find("dataWindow") + sizeof "dataWindow" + sizeof "box2i" + 4;
    exr.replace(window + 8, 4, bytesOf(100000));
    exr.replace(window + 12, 4, bytesOf(100000));
    expectError([&] { readRadiance(folder.write("a.exr", exr)); }, "a.exr", "");
}

/// OpenEXR and stb allocate what a header states before they read it.
TEST(HostileInput, SizesThatNoFileBacks) {
    const TemporaryFolder folder;
    const MemoryLimit limit;
    const std::string good = squareExr();
    const auto refuses = [&](const std::string& name, std::size_t place, const std::string& bytes,
                             const std::string& cause) {
        std::string exr = good;
        exr.replace(exr.find(name) + place, bytes.size(), bytes);
        expectError([&] { readRadiance(folder.write("a.exr", exr)); }, "a.exr", cause);
    };
    // Behind a name and a type, each with its end, is the length.
    refuses("compression", 24, bytesOf(0x7fffff00), "attribute 'compression' of 2147483392 bytes");
    refuses("compression", 24, bytesOf(2), "of type compression with 2 bytes");
    refuses("channels", 16, bytesOf(36), "of type chlist with 36 bytes");
    refuses("dataWindow", 17 + 12, bytesOf(1 << 30), "pixels in a file of");

    writePng(folder.path() / "a.png", {2, 2, std::vector<Rgb>(4, Rgb(0.5f))}, 0);
    std::string cause, png = readBytes(folder.path() / "a.png");
    EXPECT_EQ(decodeTexture(png, cause).width, 2) << cause;
    std::string wide = png;
    wide.replace(wide.find("IHDR") + 4, 8, std::string("\0\0\x40\0\0\0\x40\0", 8));
    EXPECT_TRUE(decodeTexture(wide, cause).rgba.empty());
    EXPECT_NE(cause.find("16384 x 16384 pixels"), std::string::npos) << cause;
    png.replace(png.find("IDAT") - 4, 1, "\x3f");
    EXPECT_TRUE(decodeTexture(png, cause).rgba.empty());
    EXPECT_EQ(cause, "cut short or damaged");

    // A Huffman table of more than 256 codes, for which stb has no room.
    const std::string jpeg = "\xff\xd8\xff\xc4" + std::string("\x07\0\0", 3) +
                             std::string(7, '\0') + "\x10\x20" + std::string(200, '\xff');
    EXPECT_TRUE(decodeTexture(jpeg, cause).rgba.empty());
    EXPECT_EQ(cause, "cut short or damaged");
}

/// Whatever bytes change, a file is read or refused with an Error; never a crash or a hang.
TEST(HostileInput, ChangedBytes) {
    const TemporaryFolder folder;
    const MemoryLimit limit;
    std::mt19937 random(11);
    for (const Kind& kind : kinds()) {
        for (int round = 0; round < 60; ++round) {
            std::string bytes = kind.bytes;
            for (int change = 0; change <= round % 4; ++change) {
                bytes[random() % bytes.size()] = static_cast<char>(random());
            }
            const auto path = folder.write(kind.name, bytes);
            try {
                kind.read(path);
            } catch (const Error&) {
            }
        }
    }
}

TEST(HostileInput, UnwritableOutput) {
    const TemporaryFolder folder;
    const auto file = folder.write("file", "x");
    const Image image{1, 1, {{1, 1, 1}}};
    for (const auto& path : {folder.path() / "missing" / "a", file / "a", folder.path(),
                             std::filesystem::path("/proc/a")}) {
        expectError(
            [&] {
                writeExr(path, 1, 1, {{"Y", {1.0f}}}, {}, PixelType::half);
            },
            path.string(), "");
        expectError([&] { writePng(path, image, 0.0f); }, path.string(), "");
    }
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

/// Writes with at most `limit` bytes a file, which fails as a full disk does; ends the process with
/// 0 if both failures were reported and nothing was left behind.
[[noreturn]] void writeOnFullDisk(const std::filesystem::path& folder, std::size_t limit) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit size{limit, limit};
    setrlimit(RLIMIT_FSIZE, &size);
    std::mt19937 random(3);
    std::vector<float> noise(128 * 128);
    for (float& value : noise) value = static_cast<float>(random());
    int reported = 0;
    try {
        writeExr(folder / "a.exr", 128, 128, {{"Y", noise}}, {}, PixelType::full);
    } catch (const Error& e) {
        reported += std::string(e.what()).find("cannot be written: ") != std::string::npos;
    }
    Image image{128, 128, std::vector<Rgb>(noise.size())};
    for (std::size_t i = 0; i < noise.size(); ++i) image.pixels[i] = Rgb(noise[i] * 0x1p-32f);
    try {
        writePng(folder / "a.png", image, 0.0f);
    } catch (const Error& e) {
        reported += std::string(e.what()).find("cannot be written: ") != std::string::npos;
    }
    // Without the checks at exit: the one for leaks hangs where only one of the threads was forked.
    std::_Exit(reported == 2 && std::filesystem::is_empty(folder) ? 0 : 1);
}

TEST(HostileInputDeathTest, FullDisk) {
    const TemporaryFolder folder;
    for (const std::size_t limit : {0u, 100u, 5000u, 10000u}) {
        EXPECT_EXIT(writeOnFullDisk(folder.path(), limit), testing::ExitedWithCode(0), "") << limit;
    }
}

}  // namespace
}  // namespace shadowcache::test
