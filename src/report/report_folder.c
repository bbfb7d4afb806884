/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The folder of a report, taken for the life of a run.
 *
 * A live run holds a lock on the file .running in its folder.  A process that looks into a
 * folder, takes it or moves it away holds a lock on the folder itself for that moment.  So no other
 * sees a lock file that is not locked yet, or moves a folder that has just been taken.
 */
#include "core/paths.h"
#include "core/text.h"
#include "report/report_data.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FOLDER_NUMBER_MAX = 1000000, FOLDER_RACES_MAX = 1000 };

#define LOCK_FILE ".running"

enum folder_state {
    FOLDER_EMPTY,
    FOLDER_REPORT, /* of a run that is over */
    FOLDER_LIVE,   /* of a run that lives */
    FOLDER_FOREIGN,
};

static mu_result folder_refuse(struct mu_fault *fault, const char *path, const char *why)
{
    mu_fault_at(fault, "muster run", 0, 0, "%s %s; choose another --out", path, why);
    return MU_FAULT_OS;
}

/* Adds the number to the name.  @return whether it fitted */
static bool path_number(char *to, size_t size, const char *path, int number)
{
    int len = snprintf(to, size, "%s.%d", path, number);
    return len >= 0 && (size_t)len < size;
}

/* Renames an earlier report to the first free one of .1, .2, ... */
static mu_result report_move_away(const char *path, struct mu_fault *fault)
{
    char to[REPORT_PATH_MAX];
    struct stat info;
    for (int i = 1; i <= FOLDER_NUMBER_MAX && path_number(to, sizeof to, path, i); i++) {
        if (lstat(to, &info) != 0 && errno == ENOENT) {
            return rename(path, to) == 0 ? MU_OK
                                         : mu_fault_os(fault, path, "move the earlier report");
        }
    }
    errno = EEXIST;
    return mu_fault_os(fault, path, "move the earlier report");
}

static bool folder_has(int fd, const char *name)
{
    struct stat info;
    return fstatat(fd, name, &info, AT_SYMLINK_NOFOLLOW) == 0;
}

static bool folder_is_empty(int fd)
{
    int again = openat(fd, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR *entries = again < 0 ? NULL : fdopendir(again);
    if (!entries) {
        return false;
    }
    size_t count = 0;
    for (const struct dirent *e; (e = readdir(entries));) {
        count += strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0;
    }
    closedir(entries);
    return count == 0;
}

static enum folder_state folder_look(int fd)
{
    int lock = openat(fd, LOCK_FILE, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (lock >= 0) {
        bool lives = flock(lock, LOCK_SH | LOCK_NB) != 0;
        close(lock);
        return lives ? FOLDER_LIVE : FOLDER_REPORT;
    }
    if (errno != ENOENT) {
        return FOLDER_FOREIGN; /* whose lock file we may not read */
    }
    if (folder_has(fd, "run.csv") || folder_has(fd, "summary.json")) {
        return FOLDER_REPORT;
    }
    return folder_is_empty(fd) ? FOLDER_EMPTY : FOLDER_FOREIGN;
}

/* The lock stays: its descriptor is open as long as we live. */
static mu_result folder_lock(int fd, const char *path, struct mu_fault *fault)
{
    int lock = openat(fd, LOCK_FILE, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (lock < 0) {
        return errno == ENOENT || errno == EEXIST
                   ? MU_BUSY
                   : mu_fault_os(fault, path, "write into the folder");
    }
    if (flock(lock, LOCK_EX | LOCK_NB) != 0) {
        close(lock);
        return mu_fault_os(fault, path, "lock the folder");
    }
    return MU_OK;
}

static bool is_still_at(int fd, const char *path)
{
    struct stat held, there;
    return fstat(fd, &held) == 0 && lstat(path, &there) == 0 && held.st_dev == there.st_dev &&
           held.st_ino == there.st_ino;
}

/* @return MU_OK: taken; MU_BUSY: look again; MU_EXISTS: a run lives there; or a fault */
static mu_result folder_claim(int fd, const char *path, struct mu_fault *fault)
{
    if (!is_still_at(fd, path)) {
        return MU_BUSY;
    }
    switch (folder_look(fd)) {
    case FOLDER_EMPTY: return folder_lock(fd, path, fault);
    case FOLDER_LIVE: return MU_EXISTS;
    case FOLDER_FOREIGN:
        return folder_refuse(fault, path, "is there and is not a report of muster");
    case FOLDER_REPORT: break;
    }
    mu_result moved = report_move_away(path, fault);
    return moved == MU_OK ? MU_BUSY : moved;
}

/* One look at a folder, which is made when it is missing.  Outcomes as above. */
static mu_result folder_try(const char *path, struct mu_fault *fault)
{
    if (mkdir(path, 0777) != 0 && errno != EEXIST) {
        return mu_fault_os(fault, path, "create the folder");
    }
    int fd = open(path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (fd < 0 && (errno == ENOTDIR || errno == ELOOP)) {
        return folder_refuse(fault, path, "is there and is not a report of muster");
    }
    if (fd < 0) {
        return errno == ENOENT ? MU_BUSY : mu_fault_os(fault, path, "read the folder");
    }
    /* Held for a moment only.  Where folders cannot be locked (NFS), we go on without. */
    (void)flock(fd, LOCK_EX);
    mu_result claimed = folder_claim(fd, path, fault);
    close(fd);
    return claimed;
}

static mu_result folder_take(const char *path, struct mu_fault *fault)
{
    mu_result taken = MU_BUSY;
    for (int i = 0; i < FOLDER_RACES_MAX && taken == MU_BUSY; i++) {
        taken = folder_try(path, fault);
    }
    if (taken == MU_BUSY) {
        errno = EBUSY;
        return mu_fault_os(fault, path, "take the folder");
    }
    return taken;
}

/* Takes the first free one of .1, .2, ...; earlier reports of these names stay where they are. */
static mu_result folder_take_numbered(char *taken, size_t size, const char *path,
                                      struct mu_fault *fault)
{
    struct stat info;
    for (int i = 1; i <= FOLDER_NUMBER_MAX && path_number(taken, size, path, i); i++) {
        if (lstat(taken, &info) == 0) {
            continue;
        }
        mu_result done = folder_try(taken, fault);
        if (done != MU_EXISTS && done != MU_BUSY) {
            return done;
        }
    }
    errno = EEXIST;
    return mu_fault_os(fault, path, "create a folder beside");
}

mu_result report_folder(const char *wanted, bool or_beside, char *taken, size_t size,
                        struct mu_fault *fault)
{
    char path[PATH_MAX];
    if (!mu_text_copy(path, sizeof path, wanted) || !wanted[0]) {
        errno = wanted[0] ? ENAMETOOLONG : ENOENT;
        return mu_fault_os(fault, wanted, "create the folder");
    }
    for (size_t len = strlen(path); len > 1 && path[len - 1] == '/'; len--) {
        path[len - 1] = '\0';
    }
    if (!mu_path_make_folders(path, 0777)) {
        return mu_fault_os(fault, path, "create the folder");
    }
    mu_result done = folder_take(path, fault);
    if (done == MU_EXISTS) {
        return or_beside ? folder_take_numbered(taken, size, path, fault)
                         : folder_refuse(fault, path, "is taken: another run is writing there");
    }
    if (done == MU_OK && !mu_text_copy(taken, size, path)) {
        errno = ENAMETOOLONG;
        return mu_fault_os(fault, path, "create the folder");
    }
    return done;
}

bool report_folder_lives(const char *folder)
{
    int fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    bool lives = fd >= 0 && folder_look(fd) == FOLDER_LIVE;
    if (fd >= 0) {
        close(fd);
    }
    return lives;
}

void report_folder_release(const char *folder)
{
    char path[REPORT_PATH_MAX];
    int len = snprintf(path, sizeof path, "%s/" LOCK_FILE, folder);
    if (len > 0 && (size_t)len < sizeof path) {
        unlink(path); /* one that stays is of no run that lives */
    }
}
