/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/unpack.h"

#include "core/hash.h"
#include "core/paths.h"
#include "core/text.h"
#include "muster/limits.h"
#include "muster/memory.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* Folders of ours are called so; what is kept has another name, so that no later run clears it. */
#define UNPACK_OURS "muster-verify-"
#define UNPACK_KEPT "muster-kept-"
#define UNPACK_LOCK ".owner"

enum { FILES_OPEN = 16, NEW_S = 3600 };

/* --- clearing --------------------------------------------------------------------------------- */

static int entry_remove(const char *path, const struct stat *is, int kind, struct FTW *place)
{
    (void)is;
    (void)kind;
    (void)place;
    return remove(path);
}

static void folder_remove(const char *folder)
{
    (void)nftw(folder, entry_remove, FILES_OPEN, FTW_DEPTH | FTW_PHYS);
}

/* @return whether it is a folder of this user that no process has any more.  One without a lock is
 * just being made, unless it is old. */
static bool is_left_behind(const char *folder)
{
    char path[PATH_MAX + 2 * NAME_MAX];
    struct stat is;
    if (lstat(folder, &is) != 0 || !S_ISDIR(is.st_mode) || is.st_uid != geteuid()) {
        return false;
    }
    snprintf(path, sizeof path, "%s/" UNPACK_LOCK, folder);
    int lock = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (lock < 0) {
        return errno == ENOENT && time(NULL) - is.st_mtime > NEW_S;
    }
    bool free = flock(lock, LOCK_EX | LOCK_NB) == 0;
    close(lock);
    return free;
}

static void left_behind_clear(const char *below)
{
    DIR *all = opendir(below);
    for (const struct dirent *entry; all && (entry = readdir(all));) {
        char folder[PATH_MAX + sizeof entry->d_name];
        snprintf(folder, sizeof folder, "%s/%s", below, entry->d_name);
        bool ours = strncmp(entry->d_name, UNPACK_OURS, strlen(UNPACK_OURS)) == 0;
        if (ours && is_left_behind(folder)) {
            folder_remove(folder);
        }
    }
    if (all) {
        closedir(all);
    }
}

/* The lock lives as long as this process: its descriptor stays open.  It has its name when it is
 * held, so that no process finds it free. */
static bool folder_lock(const char *folder)
{
    char draft[PATH_MAX], path[PATH_MAX];
    snprintf(draft, sizeof draft, "%s/" UNPACK_LOCK ".new", folder);
    snprintf(path, sizeof path, "%s/" UNPACK_LOCK, folder);
    int lock = open(draft, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    return lock >= 0 && flock(lock, LOCK_EX | LOCK_NB) == 0 && rename(draft, path) == 0;
}

static mu_result write_fault(const char *what, const char *path, int error)
{
    fprintf(stderr, "muster: cannot %s %s: %s; TMPDIR=DIR takes another folder\n", what, path,
            strerror(error));
    return MU_FAULT_OS;
}

static mu_result folder_make(struct unpacked *u)
{
    const char *wanted = getenv("TMPDIR");
    char below[PATH_MAX];
    wanted = wanted && wanted[0] ? wanted : "/tmp";
    if (!realpath(wanted, below)) {
        return write_fault("make a folder in", wanted, errno);
    }
    left_behind_clear(below);
    int len = snprintf(u->folder, sizeof u->folder, "%s/%sXXXXXX", below,
                       u->keeps ? UNPACK_KEPT : UNPACK_OURS);
    bool fits = len < (int)sizeof u->folder;
    if (!fits || !mkdtemp(u->folder)) {
        u->folder[0] = '\0';
        return write_fault("make a folder in", below, fits ? errno : ENAMETOOLONG);
    }
    if (!u->keeps && !folder_lock(u->folder)) {
        return write_fault("lock", u->folder, errno);
    }
    return MU_OK;
}

void unpack_close(struct unpacked *u)
{
    if (u->folder[0] && !u->keeps) {
        folder_remove(u->folder);
    }
}

/* --- the files -------------------------------------------------------------------------------- */

static const char *origin(struct mcap_reader *reader)
{
    const char *folder = mcap_reader_value(reader, "run", "folder");
    return folder ? folder : "";
}

/* @return whether each part of a path is the name of a file or a folder there */
static bool has_good_parts(const char *path)
{
    size_t len = strcspn(path, "/");
    for (;; path += len + 1, len = strcspn(path, "/")) {
        bool is_dots = (len == 1 && path[0] == '.') || (len == 2 && strncmp(path, "..", 2) == 0);
        if (len == 0 || len > NAME_MAX || is_dots) {
            return false;
        }
        if (!path[len]) {
            return true;
        }
    }
}

/* @return whether the folder that a run was started in is one: a path from the root on, or none */
static bool is_folder(const char *from)
{
    return strcmp(from, "") == 0 || strcmp(from, "/") == 0 ||
           (from[0] == '/' && has_good_parts(from + 1));
}

/* Where a recorded file is to lie: "ROLE/PATH" below the folder that the run was started in,
 * "ROLE/_/PATH" anywhere; the library apart.  @return false: it is no name of a run's file */
static bool place_find(const struct unpacked *u, const char *from, const char *name,
                       struct mu_text *path)
{
    const char *rest = strchr(name, '/');
    if (!rest || !has_good_parts(name) || !is_folder(from)) {
        return false;
    }
    mu_text_add(path, u->folder);
    if (strncmp(name, "library/", 8) == 0) {
        mu_text_add(path, "/library");
    } else if (strncmp(rest, "/_/", 3) == 0) {
        mu_text_add(path, "/files");
        rest += 2;
    } else {
        mu_text_format(path, "/files%s", from);
    }
    mu_text_add(path, rest);
    return !path->cut;
}

/* @return MU_OK; MU_MALFORMED: the name is another file's, or has one for a folder; MU_FAULT_OS */
static mu_result file_write(const struct unpacked *u, char *path, const void *bytes, size_t size)
{
    FILE *out = mu_path_make_folders(path, 0700) ? fopen(path, "wxe") : NULL;
    if (!out && (errno == EEXIST || errno == ENOTDIR || errno == EISDIR || errno == ENAMETOOLONG)) {
        return MU_MALFORMED;
    }
    bool good = out && fwrite(bytes, 1, size, out) == size;
    good = out && fclose(out) == 0 && good;
    return good ? MU_OK : write_fault("write below", u->folder, errno);
}

mu_result unpack_program(struct unpacked *u, const char *path)
{
    char bytes[PATH_MAX];
    struct mu_text link = mu_text_in(bytes, sizeof bytes);
    mu_text_format(&link, "%s/files%s", u->folder, path);
    if (path[0] != '/' || !has_good_parts(path + 1) || link.cut) {
        return MU_MALFORMED;
    }
    bool linked = mu_path_make_folders(bytes, 0700) && symlink(path, bytes) == 0;
    return linked ? MU_OK : write_fault("write below", u->folder, errno);
}

static mu_result name_fault(const char *file, const char *name)
{
    char shown[MU_TEXT_SHOWN];
    fprintf(stderr, "%s: expected files of a run, and got one named '%s'\n", file,
            mu_text_show(shown, name));
    return MU_FAULT_FILE;
}

static mu_result file_unpack(struct unpacked *u, struct mcap_reader *reader, uint32_t index,
                             const char *file, void *room)
{
    const struct mcap_attachment *a = mcap_reader_attachment(reader, index);
    char bytes[PATH_MAX];
    char shown[MU_TEXT_SHOWN];
    struct mu_text path = mu_text_in(bytes, sizeof bytes);
    if (!place_find(u, origin(reader), a->name, &path)) {
        return name_fault(file, a->name);
    }
    if (mcap_reader_attachment_read(reader, index, room, MU_RECORD_MESSAGE_MAX) != MU_OK) {
        fprintf(stderr, "%s: %s in it is not whole\n", file, mu_text_show(shown, a->name));
        return MU_FAULT_FILE;
    }
    u->files[u->files_count++] =
        (struct report_source){a->name, mu_hash_bytes(MU_HASH_EMPTY, room, (size_t)a->size)};
    if (strncmp(a->name, "experiment/", 11) == 0) {
        mu_text_copy(u->experiment, sizeof u->experiment, bytes);
    }
    if (strncmp(a->name, "world/", 6) == 0 && !u->world[0]) { /* what it includes comes after it */
        mu_text_copy(u->world, sizeof u->world, bytes);
    }
    mu_result written = file_write(u, bytes, room, (size_t)a->size);
    return written == MU_MALFORMED ? name_fault(file, a->name) : written;
}

mu_result unpack_open(struct unpacked *u, struct mcap_reader *reader, const char *file, bool keeps)
{
    *u = (struct unpacked){.keeps = keeps};
    void *room = mu_startup_alloc(MU_RECORD_MESSAGE_MAX);
    uint32_t count = 0;
    while (mcap_reader_attachment(reader, count)) {
        count++;
    }
    u->files = mu_startup_array(count, sizeof *u->files);
    mu_result done = folder_make(u);
    for (uint32_t i = 0; done == MU_OK && i < count; i++) {
        done = file_unpack(u, reader, i, file, room);
    }
    return done;
}

const char *unpack_path(const struct unpacked *u, const char *path)
{
    size_t len = strlen(u->folder);
    bool ours =
        len > 0 && strncmp(path, u->folder, len) == 0 && strncmp(path + len, "/files/", 7) == 0;
    return ours ? path + len + 6 : path;
}
