// Loaded in front of a program (LD_PRELOAD): makes one call of a function fail, as a full disk or
// little memory does. Calls are counted from main() on.
//   FAULT_CALL  malloc, read, write, sync, rename, map, thread or none
//   FAULT_AT    which call fails, from 1; 0: none
//   FAULT_ON    1: all later calls fail, too
//   FAULT_COUNT file that receives the number of calls when the program ends
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

extern void* __libc_malloc(size_t);
extern void* __libc_calloc(size_t, size_t);
extern void* __libc_realloc(void*, size_t);
extern void* __libc_memalign(size_t, size_t);

static const char* faulty = "none";
static long failAt, goesOn;
static atomic_long calls;
static atomic_int armed;

// Whether this call of `name` is to fail.
static int fails(const char* name) {
    if (!atomic_load(&armed) || strcmp(name, faulty) != 0) return 0;
    const long n = atomic_fetch_add(&calls, 1) + 1;
    return failAt > 0 && (n == failAt || (goesOn && n > failAt));
}

// Blosc 1.21 writes to what it was given, memory or not; that is not ours to mend.
static int isBlosc(const void* caller) {
    Dl_info place;
    return dladdr(caller, &place) && place.dli_fname && strstr(place.dli_fname, "libblosc");
}

#define NO_MEMORY (fails("malloc") && !isBlosc(__builtin_return_address(0)))

static int refuse(int error) {
    errno = error;
    return -1;
}

#define REAL(name) \
    static __typeof__(name)* real; \
    if (!real) real = (__typeof__(name)*)dlsym(RTLD_NEXT, #name)

void* malloc(size_t size) {
    if (NO_MEMORY) return refuse(ENOMEM), NULL;
    return __libc_malloc(size);
}
void* calloc(size_t count, size_t size) {
    if (NO_MEMORY) return refuse(ENOMEM), NULL;
    return __libc_calloc(count, size);
}
void* realloc(void* block, size_t size) {
    if (NO_MEMORY) return refuse(ENOMEM), NULL;
    return __libc_realloc(block, size);
}
void* memalign(size_t alignment, size_t size) {
    if (NO_MEMORY) return refuse(ENOMEM), NULL;
    return __libc_memalign(alignment, size);
}
void* aligned_alloc(size_t alignment, size_t size) {
    if (NO_MEMORY) return refuse(ENOMEM), NULL;
    return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, size_t alignment, size_t size) {
    if (NO_MEMORY) return ENOMEM;
    *out = __libc_memalign(alignment, size);
    return *out ? 0 : ENOMEM;
}

ssize_t read(int file, void* bytes, size_t count) {
    if (fails("read")) return refuse(EIO);
    return syscall(SYS_read, file, bytes, count);
}
ssize_t pread(int file, void* bytes, size_t count, off_t offset) {
    if (fails("read")) return refuse(EIO);
    return syscall(SYS_pread64, file, bytes, count, offset);
}
ssize_t pread64(int file, void* bytes, size_t count, off64_t offset) {
    return pread(file, bytes, count, offset);
}
// The C library's own reads and writes do not come by here.
size_t fread(void* bytes, size_t size, size_t count, FILE* file) {
    REAL(fread);
    if (fails("read")) return refuse(EIO), 0;
    return real(bytes, size, count, file);
}
// What is said to the user is not to fail.
static int isTold(FILE* file) { return file == stdout || file == stderr; }
size_t fwrite(const void* bytes, size_t size, size_t count, FILE* file) {
    REAL(fwrite);
    if (!isTold(file) && fails("write")) return refuse(ENOSPC), 0;
    return real(bytes, size, count, file);
}
int fflush(FILE* file) {
    REAL(fflush);
    if (file && !isTold(file) && fails("write")) return refuse(ENOSPC), EOF;
    return real(file);
}
ssize_t write(int file, const void* bytes, size_t count) {
    if (file > STDERR_FILENO && fails("write")) return refuse(ENOSPC);
    return syscall(SYS_write, file, bytes, count);
}
ssize_t writev(int file, const struct iovec* bytes, int count) {
    if (file > STDERR_FILENO && fails("write")) return refuse(ENOSPC);
    return syscall(SYS_writev, file, bytes, count);
}
int fsync(int file) {
    if (fails("sync")) return refuse(EIO);
    return (int)syscall(SYS_fsync, file);
}
int rename(const char* from, const char* to) {
    if (fails("rename")) return refuse(EIO);
    return (int)syscall(SYS_rename, from, to);
}
void* mmap(void* at, size_t length, int protection, int flags, int file, off_t offset) {
    if (fails("map")) return refuse(ENOMEM), MAP_FAILED;
    return (void*)syscall(SYS_mmap, at, length, protection, flags, file, offset);
}
void* mmap64(void* at, size_t length, int protection, int flags, int file, off64_t offset) {
    return mmap(at, length, protection, flags, file, offset);
}
int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*run)(void*),
                   void* argument) {
    REAL(pthread_create);
    if (fails("thread")) return EAGAIN;
    return real(thread, attributes, run, argument);
}

static void report(void) {
    atomic_store(&armed, 0);
    const char* path = getenv("FAULT_COUNT");
    if (!path) return;
    char text[32];
    const int length = snprintf(text, sizeof text, "%ld\n", atomic_load(&calls));
    const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    if (file < 0 || syscall(SYS_write, file, text, length) < 0) _exit(99);
    close(file);
}

static int (*realMain)(int, char**, char**);
static int countedMain(int argc, char** argv, char** environment) {
    if (getenv("FAULT_CALL")) faulty = getenv("FAULT_CALL");
    failAt = getenv("FAULT_AT") ? atol(getenv("FAULT_AT")) : 0;
    goesOn = getenv("FAULT_ON") ? atol(getenv("FAULT_ON")) : 0;
    atexit(report);
    atomic_store(&armed, 1);
    const int status = realMain(argc, argv, environment);
    atomic_store(&armed, 0);
    return status;
}

int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(void),
                      void (*fini)(void), void (*rtldFini)(void), void* stackEnd) {
    REAL(__libc_start_main);
    realMain = main;
    return real(countedMain, argc, argv, init, fini, rtldFini, stackEnd);
}
