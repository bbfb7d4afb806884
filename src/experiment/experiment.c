/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/experiment.h"

#include "core/text_file.h"
#include "experiment/experiment_source.h"
#include "muster/memory.h"

#include <errno.h>
#include <string.h>

/* The text is needed while the experiment is loaded, and no longer. */
static char experiment_text[EXPERIMENT_BYTES_MAX + 1];

static mu_result experiment_read(const char *path, size_t *len, struct mu_fault *fault)
{
    struct mu_text text = mu_text_in(experiment_text, sizeof experiment_text);
    mu_result result = mu_text_file_read(path, &text, fault);
    *len = text.len;
    if (result != MU_OK) {
        return mu_fault_at(fault, path, 0, 0, "cannot read the experiment: %s", strerror(errno));
    }
    return text.cut ? mu_fault_at(fault, path, 0, 0, "expected an experiment of at most %d bytes",
                                  EXPERIMENT_BYTES_MAX)
                    : MU_OK;
}

static mu_result experiment_take_folder(struct experiment_source *source)
{
    struct experiment *e = source->experiment;
    const char *slash = strrchr(source->path, '/');
    struct mu_text folder = mu_text_in(e->folder, sizeof e->folder);
    if (slash) {
        size_t len = slash == source->path ? 1 : (size_t)(slash - source->path);
        mu_text_add_bytes(&folder, source->path, len);
    } else {
        mu_text_add(&folder, ".");
    }
    return folder.cut
               ? mu_fault_at(source->fault, source->path, 0, 0,
                             "expected a folder's path of at most %zu bytes", sizeof e->folder - 1)
               : MU_OK;
}

static mu_result experiment_load_tree(struct experiment_source *source, const char *const *set,
                                      size_t set_count)
{
    source->experiment = mu_startup_alloc(sizeof *source->experiment);
    MU_TRY(yaml_keys_read(source->tree, yaml_tree_root(source->tree), experiment_schema,
                          source->experiment, source->fault));
    MU_TRY(experiment_take_folder(source));
    MU_TRY(experiment_fill(source));
    for (size_t i = 0; i < set_count; i++) {
        MU_TRY(experiment_override(source, set[i]));
    }
    return experiment_check(source);
}

mu_result experiment_load(struct experiment **out, const char *path, const char *const *set,
                          size_t set_count, struct mu_fault *fault)
{
    struct experiment_source *source = mu_startup_alloc(sizeof *source);
    size_t len = 0;
    *out = NULL;
    source->path = mu_startup_string(path);
    source->fault = fault;
    MU_TRY(experiment_read(source->path, &len, fault));
    MU_TRY(yaml_tree_open(&source->tree, source->path, experiment_text, len, fault));
    mu_result result = experiment_load_tree(source, set, set_count);
    yaml_tree_close(source->tree);
    if (result == MU_OK) {
        *out = source->experiment;
    }
    return result;
}
