/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/raw/raw.h"
#include "sim/record/record.h"

#include "core/arithmetic.h"
#include "core/clock.h"
#include "core/paths.h"
#include "core/table.h"
#include "core/text.h"
#include "mcap/mcap.h"
#include "muster/memory.h"
#include "muster/version.h"
#include "world/parse/parser.h"

#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { PAIRS_MAX = 2 * MU_OPTION_LIST_MAX + 24, NAME_SIZE = 1024, SCHEMA_SIZE = 64 * 1024 };

struct mcap_file {
    struct mcap_writer *file;
    bool without_percepts;
    uint32_t scenes, frames, states; /* channels */
    uint32_t sequence;
    struct bus_bytes bytes; /* of the message written last */
    struct mcap_pair pairs[PAIRS_MAX];
    char keys[PAIRS_MAX][64];
};

/* --- files and notes of the run --------------------------------------------------------------- */

/* @return the media type of a file, for programs that show it */
static const char *media_type(const char *path)
{
    static const struct {
        const char *end, *type;
    } types[] = {{".yaml", "application/yaml"}, {".clp", "text/x-clips"},
                 {".world", "text/plain"},      {".inc", "text/plain"},
                 {".png", "image/png"},         {".pgm", "image/x-portable-graymap"},
                 {".policy", "text/plain"}};
    size_t len = strlen(path);
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        size_t end = strlen(types[i].end);
        if (len >= end && strcmp(path + len - end, types[i].end) == 0) {
            return types[i].type;
        }
    }
    return "application/octet-stream";
}

/* Makes the name of a file in the recording.  It has no "..", so unpacking stays within a folder.
 */
static void name_make(struct mu_text *name, const char *said)
{
    while (*said) {
        size_t len = strcspn(said, "/");
        bool is_dots = (len == 1 && said[0] == '.') || (len == 2 && strncmp(said, "..", 2) == 0);
        if (len > 0 && !is_dots) {
            mu_text_add(name, name->len > 0 ? "/" : "");
            mu_text_add_bytes(name, said, len);
        }
        said += len + (said[len] == '/');
    }
}

/* Splits "NAME=PATH"; "==" is an equals sign in the name.  @return the path */
static const char *word_split(const char *word, struct mu_text *name)
{
    for (; *word && (*word != '=' || word[1] == '='); word++) {
        word += *word == '=';
        mu_text_add_bytes(name, word, 1);
    }
    return word + (*word == '=');
}

static void file_attach(struct mcap_file *f, const struct mu_text *said, const char *path)
{
    char bytes[NAME_SIZE];
    struct mu_text name = mu_text_in(bytes, sizeof bytes);
    name_make(&name, said->at);
    mu_result taken =
        said->cut ? MU_FULL : mcap_writer_attach_file(f->file, name.at, media_type(path), path);
    if (taken > 0) {
        fprintf(stderr, "muster sim: %s is not in the recording: %s\n", path,
                taken == MU_FULL ? "it is too large" : "it cannot be read");
    }
}

static void files_attach(struct mcap_file *f, const struct mu_option_list *files)
{
    char bytes[NAME_SIZE];
    struct mu_text name;
    for (size_t i = 0; i < files->count; i++) {
        mu_text_init(&name, bytes, sizeof bytes);
        const char *path = word_split(files->items[i], &name);
        file_attach(f, &name, path);
    }
}

/* Attaches the files that a world was read from. */
static void world_attach(struct mcap_file *f, const struct world_file *world)
{
    char bytes[NAME_SIZE];
    struct mu_text name;
    for (size_t i = 0; i < world->files_count; i++) {
        mu_text_init(&name, bytes, sizeof bytes);
        mu_text_add(&name, "world");
        mu_path_portable(&name, world->files[i]);
        file_attach(f, &name, world->files[i]);
    }
}

/* Splits "KEY=VALUE".  Leaves a note without a key out.  @return the number of pairs */
static size_t notes_fill(struct mcap_file *f, const struct mu_option_list *notes, size_t count)
{
    for (size_t i = 0; i < notes->count && count < PAIRS_MAX; i++) {
        size_t key = strcspn(notes->items[i], "=");
        if (notes->items[i][key] == '=' && key < sizeof f->keys[0]) {
            snprintf(f->keys[count], sizeof f->keys[0], "%.*s", (int)key, notes->items[i]);
            f->pairs[count] = (struct mcap_pair){f->keys[count], notes->items[i] + key + 1};
            count++;
        }
    }
    return count;
}

/* In a run that was started by hand, notes where robots were put.  @return the number of pairs */
static size_t places_fill(struct mcap_file *f, const struct mu_option_list *places, size_t count)
{
    for (size_t i = 0; i < places->count; i++) {
        snprintf(f->keys[count], sizeof f->keys[0], "place.%zu", i + 1);
        f->pairs[count] = (struct mcap_pair){f->keys[count], places->items[i]};
        count++;
    }
    return count;
}

static void table_write(struct mcap_file *f, const struct mcap_file_options *options)
{
    char began[24], seed[24], duration[32], here[PATH_MAX], processor[MU_PROCESSOR_MAX];
    mu_processor(processor);
    snprintf(began, sizeof began, "%" PRIu64, mu_clock_wall_ns());
    snprintf(seed, sizeof seed, "%" PRIu64, options->seed);
    snprintf(duration, sizeof duration, "%.17g", options->duration_s);
    const struct mcap_pair own[] = {
        {"muster", MU_VERSION},
        {"cyclonedds", bus_version()},
        {"ode", ode_world_version()},
        {"arithmetic", MU_ARITHMETIC},
        {"architecture", mu_architecture()},
        {"processor", processor},
        {"record", f->without_percepts ? "run" : "full"},
        {"began_wall_ns", began},
        {"log_time", "simulated time, nanoseconds from the start of the run"},
        {"publish_time", "wall clock, nanoseconds since 1970"},
        {"seed", seed},
        {"duration_s", duration},
        {"lockstep", options->free ? "no" : "yes"},
        {"folder", getcwd(here, sizeof here) ? here : ""},
        {"command", options->command},
    };
    enum { OWN = sizeof own / sizeof own[0], BY_HAND = 5 };
    size_t count = options->command ? OWN : OWN - BY_HAND;
    memcpy(f->pairs, own, sizeof own);
    if (options->command) {
        count = places_fill(f, options->places, count);
    }
    (void)mcap_writer_metadata(f->file, "run", f->pairs, notes_fill(f, options->notes, count));
}

/* --- channels --------------------------------------------------------------------------------- */

static uint32_t channel_add(struct mcap_file *f, enum bus_topic topic)
{
    static char schema_bytes[SCHEMA_SIZE];
    char name_bytes[NAME_SIZE], profile_bytes[NAME_SIZE];
    uint32_t channel = MU_NONE;
    struct mu_text name = mu_text_in(name_bytes, sizeof name_bytes);
    struct mu_text schema = mu_text_in(schema_bytes, sizeof schema_bytes);
    struct mu_text profile = mu_text_in(profile_bytes, sizeof profile_bytes);
    MU_ASSERT(bus_schema(topic, &name, &schema) == MU_OK);
    bus_profile(topic, &profile);
    const struct mcap_pair pairs[] = {{"offered_qos_profiles", profile.at}};
    struct mcap_channel c = {.topic = bus_topic_name(topic),
                             .encoding = "cdr",
                             .schema_name = name.at,
                             .schema_encoding = "ros2msg",
                             .schema = schema.at,
                             .schema_size = schema.len,
                             .pairs = pairs,
                             .pairs_count = 1};
    MU_ASSERT(mcap_writer_channel(f->file, &c, &channel) == MU_OK);
    return channel;
}

mu_result mcap_file_open(struct mcap_file **out, const struct mcap_file_options *options)
{
    struct mcap_file *f = mu_startup_alloc(sizeof *f);
    f->file = mcap_writer_create();
    f->without_percepts = options->without_percepts;
    MU_TRY(mcap_writer_open(f->file, options->path, "muster " MU_VERSION));
    table_write(f, options);
    files_attach(f, options->files);
    if (options->command) {
        world_attach(f, options->world->source);
    }
    f->scenes = channel_add(f, BUS_SCENE);
    f->frames = channel_add(f, BUS_FRAME);
    f->states = channel_add(f, BUS_RUN_STATUS);
    *out = f;
    return MU_OK;
}

/* --- the run ---------------------------------------------------------------------------------- */

static void message_add(struct mcap_file *f, enum bus_topic topic, uint32_t channel,
                        uint64_t time_ns, const void *sample)
{
    if (bus_encode(topic, sample, &f->bytes) != MU_OK) {
        return;
    }
    struct mcap_message m = {.channel = channel,
                             .sequence = f->sequence++,
                             .log_ns = time_ns,
                             .publish_ns = mu_clock_wall_ns(),
                             .data = f->bytes.data,
                             .size = f->bytes.size};
    (void)mcap_writer_message(f->file, &m);
}

void mcap_file_scene(struct mcap_file *f, const muster_Scene *scene)
{
    message_add(f, BUS_SCENE, f->scenes, 0, scene);
}

void mcap_file_frame(struct mcap_file *f, const muster_Frame *frame)
{
    muster_Frame part = *frame;
    part.percepts._length = f->without_percepts ? 0 : part.percepts._length;
    message_add(f, BUS_FRAME, f->frames, frame->time_ns, &part);
}

static void end_write(struct mcap_file *f, const muster_RunStatus *status)
{
    char steps[24], time[24], wall[24];
    snprintf(steps, sizeof steps, "%lld", (long long)status->step);
    snprintf(time, sizeof time, "%" PRIu64, status->time_ns);
    snprintf(wall, sizeof wall, "%" PRIu64, status->wall_ns);
    const struct mcap_pair end[] = {{"hash", status->hash},
                                    {"steps", steps},
                                    {"time_ns", time},
                                    {"wall_ns", wall},
                                    {"state", status->state == muster_RUN_DONE ? "done" : "fault"},
                                    {"why", status->waits_for}};
    (void)mcap_writer_metadata(f->file, "end", end, sizeof end / sizeof end[0]);
}

void mcap_file_end(struct mcap_file *f, const muster_RunStatus *status)
{
    message_add(f, BUS_RUN_STATUS, f->states, status->time_ns, status);
    end_write(f, status);
}

mu_result mcap_file_close(struct mcap_file *f)
{
    bus_bytes_free(&f->bytes);
    uint64_t refused = mcap_writer_refused(f->file);
    if (refused > 0) {
        fprintf(stderr,
                "muster sim: %" PRIu64 " messages or files are too long for the recording\n",
                refused);
    }
    return mcap_writer_close(f->file);
}
