/* SPDX-License-Identifier: Apache-2.0 */
#include "core/text_file.h"
#include "muster/memory.h"
#include "report/report_data.h"

#include <unistd.h>

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
    struct mu_draft draft;
    MU_TRY(mu_draft_open(&draft, folder, what->name, fault));
    if (what->write) {
        what->write(draft.file, data);
    } else {
        what->write_page(draft.file, data, folder);
    }
    return mu_draft_close(&draft, true, fault);
}

static void colors_choose(struct report_data *data)
{
    size_t count = data->input->robots_count;
    struct palette_robot *robots = mu_startup_array(count, sizeof *robots);
    data->colors = mu_startup_array(count, sizeof *data->colors);
    for (size_t i = 0; i < count; i++) {
        const struct report_robot *robot = &data->input->robots[i];
        robots[i] = (struct palette_robot){robot->name, robot->rgb, false};
    }
    palette_choose(data->colors, robots, count);
}

mu_result report_write(const char *folder, const struct report_input *input,
                       struct report_result *result, struct mu_fault *fault)
{
    MU_ASSERT(input->robots_count <= MU_ROBOTS_MAX);
    struct report_data data = {.input = input, .result = result};
    colors_choose(&data);
    mu_result done = report_stats(&data, folder, fault);
    for (size_t i = 0; done == MU_OK && i < sizeof report_files / sizeof report_files[0]; i++) {
        done = report_write_file(&report_files[i], folder, &data, fault);
    }
    return done;
}
