/* Faults of disk, memory and power at a chosen moment, preloaded into closecall by torture.rs.
 *
 * FAULT     what fails, see below
 * FAULT_AT  the number of the operation at which it fails, from 1 on; after the last: as the process ends
 * FAULT_IN  the folder whose files are meant, whole path; relative paths are taken to be in it
 * FAULT_LOG the file that gets the number of operations and allocations
 *
 * An operation creates, writes, forces to disk, shortens, renames or removes a file, or makes a folder. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum fault {
    NONE,
    KILL,  /* the process is killed before the operation */
    HALF,  /* the process is killed in the middle of the next write */
    ERROR, /* the operation fails with EIO, later ones do not */
    FULL,  /* the disk has room for half of the next write, and for none after it */
    ROOM,  /* the disk has no room for the next write, but for those after it */
    POWER, /* the process is killed, and what was not forced to disk is lost */
    READ,  /* a read, counted by itself, fails with EIO */
    MEMORY /* an allocation, counted by itself, fails */
};
static const char *const NAMES[] = {"none", "kill", "half", "error", "full", "room", "power", "read", "memory"};

static enum fault fault;
static long at;
static const char *folder;
static atomic_long operations, reads, allocations;
static atomic_int is_full, is_over;

#define REAL(name) __extension__({ \
    static __typeof__(name) *real; \
    if (!real) real = (__typeof__(name) *)dlsym(RTLD_NEXT, #name); \
    real; })

static int is_in_folder(const char *path) {
    size_t length = folder ? strlen(folder) : 0;
    return length && path && (*path != '/' || !strncmp(path, folder, length));
}

static int is_file_in_folder(int file) {
    char link[32], path[PATH_MAX];
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    ssize_t length = folder ? readlink(link, path, sizeof path - 1) : -1;
    if (length < 0 || *path != '/') return 0; /* a pipe has no path */
    path[length] = 0;
    return is_in_folder(path);
}

/* The files that were written, each with as much of it as is on disk for certain. */
static struct { dev_t device; ino_t number; int file; off_t synced; } written[64];
static int files;

static void remember(int file, int is_synced) {
    struct stat now;
    if (fault != POWER || fstat(file, &now) || !S_ISREG(now.st_mode)) return;
    int place = 0;
    while (place < files && (written[place].device != now.st_dev || written[place].number != now.st_ino)) place++;
    if (place == 64) abort();
    if (place == files) {
        written[files].device = now.st_dev;
        written[files].number = now.st_ino;
        written[files].synced = 0;
        written[files++].file = fcntl(file, F_DUPFD_CLOEXEC, 200);
    }
    if (is_synced || written[place].synced > now.st_size) written[place].synced = now.st_size;
}

_Noreturn static void die(void) {
    if (fault == POWER)
        for (int place = 0; place < files; place++)
            if (REAL(ftruncate)(written[place].file, written[place].synced)) abort();
    raise(SIGKILL);
    abort();
}

enum what { GOES, FAILS, GETS_HALF };

static enum what fails(int error) {
    errno = error;
    return FAILS;
}

static enum what next(int is_write) {
    if (++operations < at || at < 1 || is_over) return GOES;
    if (fault == KILL || fault == POWER) die();
    if (fault == ERROR) {
        is_over = 1;
        return fails(EIO);
    }
    if (!is_write) return GOES;
    if (fault == ROOM) {
        is_over = 1;
        return fails(ENOSPC);
    }
    if (fault == FULL) return is_full++ ? fails(ENOSPC) : GETS_HALF;
    return fault == HALF ? GETS_HALF : GOES;
}

ssize_t write(int file, const void *bytes, size_t count) {
    if (!is_file_in_folder(file)) return REAL(write)(file, bytes, count);
    enum what what = next(1);
    ssize_t done = what == FAILS ? -1 : REAL(write)(file, bytes, what == GETS_HALF ? (count + 1) / 2 : count);
    if (what == GETS_HALF && fault == HALF) die();
    remember(file, 0);
    return done;
}

ssize_t read(int file, void *bytes, size_t count) {
    if (is_file_in_folder(file) && ++reads == at && fault == READ) {
        errno = EIO;
        return -1;
    }
    return REAL(read)(file, bytes, count);
}

#define ON_FILE(name, parameters, arguments, is_sync) \
    int name parameters { \
        if (!is_file_in_folder(file)) return REAL(name) arguments; \
        if (next(0) != GOES) return -1; \
        int done = REAL(name) arguments; \
        remember(file, (is_sync) && !done); \
        return done; \
    }
ON_FILE(fsync, (int file), (file), 1)
ON_FILE(fdatasync, (int file), (file), 1)
ON_FILE(ftruncate, (int file, off_t size), (file, size), 0)
ON_FILE(ftruncate64, (int file, off64_t size), (file, size), 0)

#define ON_PATH(name, parameters, arguments) \
    int name parameters { return is_in_folder(path) && next(0) != GOES ? -1 : REAL(name) arguments; }
ON_PATH(rename, (const char *path, const char *to), (path, to))
ON_PATH(unlink, (const char *path), (path))
ON_PATH(mkdir, (const char *path, mode_t mode), (path, mode))

#define OPEN(name) \
    int name(const char *path, int flags, ...) { \
        va_list list; \
        va_start(list, flags); \
        int mode = flags & O_CREAT ? va_arg(list, int) : 0; \
        va_end(list); \
        return flags & O_CREAT && is_in_folder(path) && next(0) != GOES ? -1 : REAL(name)(path, flags, mode); \
    }
OPEN(open)
OPEN(open64)

void *__libc_malloc(size_t), *__libc_calloc(size_t, size_t), *__libc_realloc(void *, size_t);

static int has_memory(void) {
    if (++allocations != at || fault != MEMORY) return 1;
    errno = ENOMEM;
    return 0;
}

void *malloc(size_t size) { return has_memory() ? __libc_malloc(size) : NULL; }
void *calloc(size_t count, size_t size) { return has_memory() ? __libc_calloc(count, size) : NULL; }
void *realloc(void *memory, size_t size) { return has_memory() ? __libc_realloc(memory, size) : NULL; }

__attribute__((constructor)) static void begin(void) {
    const char *name = getenv("FAULT"), *number = getenv("FAULT_AT");
    for (int place = 0; name && place <= MEMORY; place++)
        if (!strcmp(name, NAMES[place])) fault = place;
    folder = getenv("FAULT_IN");
    at = number ? atol(number) : -1;
    allocations = 0;
}

__attribute__((destructor)) static void end(void) {
    const char *path = getenv("FAULT_LOG");
    if (path) {
        char text[96];
        int length = snprintf(text, sizeof text, "%ld %ld %ld", operations, reads, allocations);
        int file = REAL(open)(path, O_WRONLY | O_CREAT | O_TRUNC, 0644);
        if (file < 0 || REAL(write)(file, text, length) != length) abort();
    }
    if (fault == POWER) die();
}
