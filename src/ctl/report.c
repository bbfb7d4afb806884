/* SPDX-License-Identifier: Apache-2.0 */
#include "ctl/report.h"

#include "core/text.h"
#include "ctl/color.h"
#include "ctl/report_data.h"
#include "muster/memory.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { REPORT_EARLIER_MAX = 1000000 };

static mu_result report_os_fault(struct mu_fault *fault, const char *path, const char *what)
{
    mu_fault_at(fault, path, 0, 0, "cannot %s: %s", what, strerror(errno));
    return MU_FAULT_OS;
}

/* --- the folder ------------------------------------------------------------------------------- */

/* Creates a folder with its parents. */
static mu_result report_make_folders(char *path, struct mu_fault *fault)
{
    for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        int made = mkdir(path, 0777);
        if (made != 0 && errno != EEXIST) {
            return report_os_fault(fault, path, "create the folder");
        }
        *slash = '/';
    }
    return mkdir(path, 0777) == 0 ? MU_OK : report_os_fault(fault, path, "create the folder");
}

/* Renames an earlier folder to the first free one of .1, .2, ... */
static mu_result report_move_away(const char *path, struct mu_fault *fault)
{
    char to[REPORT_PATH_MAX];
    struct stat info;
    for (int i = 1; i <= REPORT_EARLIER_MAX; i++) {
        int len = snprintf(to, sizeof to, "%s.%d", path, i);
        if (len < 0 || (size_t)len >= sizeof to) {
            break;
        }
        if (lstat(to, &info) != 0 && errno == ENOENT) {
            return rename(path, to) == 0 ? MU_OK
                                         : report_os_fault(fault, path, "move the earlier report");
        }
    }
    errno = EEXIST;
    return report_os_fault(fault, path, "move the earlier report");
}

mu_result report_folder(const char *folder, struct mu_fault *fault)
{
    char path[PATH_MAX];
    struct stat info;
    if (!mu_text_copy(path, sizeof path, folder) || !folder[0]) {
        errno = folder[0] ? ENAMETOOLONG : ENOENT;
        return report_os_fault(fault, folder, "create the folder");
    }
    for (size_t len = strlen(path); len > 1 && path[len - 1] == '/'; len--) {
        path[len - 1] = '\0';
    }
    if (lstat(path, &info) == 0) {
        mu_result moved = report_move_away(path, fault);
        if (moved != MU_OK) {
            return moved;
        }
    }
    return report_make_folders(path, fault);
}

/* --- the files -------------------------------------------------------------------------------- */

struct report_file {
    const char *name;
    void (*write)(FILE *, const struct report_data *);
    void (*write_page)(FILE *, const struct report_data *, const char *folder);
};

/* The page is last: it links to what is there. */
static const struct report_file report_files[] = {
    {"summary.json", report_write_json, NULL},
    {"tracks.svg", report_write_tracks, NULL},
    {"bearing.svg", report_write_bearing, NULL},
    {"report.html", NULL, report_write_html},
};

static mu_result report_write_file(const struct report_file *what, const char *folder,
                                   const struct report_data *data, struct mu_fault *fault)
{
    char path[REPORT_PATH_MAX], draft[REPORT_PATH_MAX];
    int len = snprintf(draft, sizeof draft, "%s/.%s.new", folder, what->name);
    if (len < 0 || (size_t)len >= sizeof draft) {
        errno = ENAMETOOLONG;
        return report_os_fault(fault, folder, "write the report");
    }
    snprintf(path, sizeof path, "%s/%s", folder, what->name);
    FILE *file = fopen(draft, "we");
    if (!file) {
        return report_os_fault(fault, path, "write");
    }
    if (what->write) {
        what->write(file, data);
    } else {
        what->write_page(file, data, folder);
    }
    errno = 0;
    bool written = fflush(file) == 0 && !ferror(file);
    int why = errno ? errno : EIO;
    bool closed = fclose(file) == 0;
    if (!written || !closed || rename(draft, path) != 0) {
        why = written ? errno : why;
        unlink(draft);
        errno = why;
        return report_os_fault(fault, path, "write");
    }
    return MU_OK;
}

mu_result report_write(const char *folder, const struct report_input *input,
                       struct report_result *result, struct mu_fault *fault)
{
    MU_ASSERT(input->robots_count <= MU_ROBOTS_MAX);
    struct report_data data = {.input = input, .result = result};
    data.colors = mu_startup_array(input->robots_count, sizeof *data.colors);
    for (size_t i = 0; i < input->robots_count; i++) {
        data.colors[i] = color_of_track(input->robots[i].color, input->robots[i].name, i);
    }
    mu_result done = report_stats(&data, folder, fault);
    for (size_t i = 0; done == MU_OK && i < sizeof report_files / sizeof report_files[0]; i++) {
        done = report_write_file(&report_files[i], folder, &data, fault);
    }
    return done;
}
