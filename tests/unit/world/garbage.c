/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Damaged world files: whatever the wounds, loading ends, says the same twice, and names a place.
 *
 * The files of tests/corpus/world are wounded at random, from another seed where MUSTER_SEED names
 * one, and so many times as MUSTER_ROUNDS says.
 */
#include "core/hash.h"
#include "garble.h"
#include "suite.h"
#include "world/read/builder.h"
#include "world/world_load.h"
#include "world_text.h"

#include <glob.h>
#include <math.h>
#include <stdlib.h>

enum { SAMPLES_MAX = 32, SAMPLE_BYTES_MAX = 4096, ROUNDS = 1500 };

static struct sample {
    char text[SAMPLE_BYTES_MAX];
    size_t len;
} samples[SAMPLES_MAX];
static size_t sample_count;
static struct world world; /* read again and again */
static char path[] = "/tmp/muster-world-XXXXXX";

static int begin(void)
{
    glob_t found = {0};
    if (glob("tests/corpus/world/*.world", 0, NULL, &found) != 0) {
        return 1;
    }
    for (size_t i = 0; i < found.gl_pathc && sample_count < SAMPLES_MAX; i++) {
        FILE *file = fopen(found.gl_pathv[i], "r");
        if (!file) {
            return 1;
        }
        struct sample *s = &samples[sample_count++];
        s->len = fread(s->text, 1, sizeof s->text, file);
        fclose(file);
    }
    globfree(&found);
    int fd = mkstemp(path);
    return fd < 0 || close(fd) != 0;
}

static int end(void)
{
    return unlink(path);
}

static void write_world(const char *text, size_t len)
{
    FILE *file = fopen(path, "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    CU_ASSERT_EQUAL(fwrite(text, 1, len, file), len);
    CU_ASSERT_EQUAL(fclose(file), 0);
}

/* What a listener heard. */
struct heard {
    size_t mistakes, placeless;
    uint64_t texts;
};

static void hear(void *self, const struct mu_fault *f, bool mistake)
{
    struct heard *h = self;
    h->mistakes += mistake;
    h->placeless += f->text[0] == '\0' || (f->line < 1 || f->column < 1);
    h->texts =
        h->texts * 31 + mu_hash_string(f->text) + (uint64_t)f->line * 7 + (uint64_t)f->column;
}

/* Reads the file with a listener, as `muster world check` does. */
static mu_result read_all(struct heard *heard)
{
    struct mu_fault_listener listener = {.tell = hear, .self = heard};
    struct world_options options = {.seed = 1, .listener = &listener};
    *heard = (struct heard){0};
    mu_result r = world_read(&world, path, &options, &fault);
    mu_result placed = world_check_places(&world, &listener, &fault);
    return r == MU_OK ? placed : r;
}

static bool is_sane(const struct world *w)
{
    double sum = w->min_x_m + w->min_y_m + w->max_x_m + w->max_y_m;
    for (size_t i = 0; i < w->robot_count; i++) {
        const struct world_robot *r = &w->robots[i];
        sum += r->pose.x_m + r->pose.y_m + r->pose.heading_rad + r->mass_kg + r->turn_max_rad_s +
               r->odometry.start.x_m + r->battery_j + r->laser.fov_rad + r->gripper.length_m;
        if (!(r->length_m > 0 && r->width_m > 0 && r->mass_kg > 0) || r->name[0] == '\0' ||
            r->sonar_count > MU_SONARS_MAX || r->laser.samples > MU_BEAMS_MAX ||
            r->camera.columns > MU_COLUMNS_MAX || r->camera.color_count > MU_COLORS_MAX) {
            return false;
        }
    }
    for (size_t i = 0; i < w->object_count; i++) {
        const struct world_object *o = &w->objects[i];
        sum += o->shape.pose.x_m + o->shape.pose.y_m + o->mass_kg + o->friction;
        if (!(o->mass_kg > 0) || o->name[0] == '\0') {
            return false;
        }
    }
    return isfinite(sum);
}

static void test_wounded_files(void)
{
    struct mu_random random;
    uint64_t seed = suite_setting("MUSTER_SEED", 41);
    uint64_t rounds = suite_setting("MUSTER_ROUNDS", ROUNDS);
    size_t refused = 0;
    size_t wrong = 0;
    mu_random_seed(&random, seed, "wounded worlds");
    printf("seed %llu ", (unsigned long long)seed);
    int kept = hush();
    for (uint64_t round = 0; round < rounds && wrong == 0; round++) {
        char text[2 * SAMPLE_BYTES_MAX];
        const struct sample *s = &samples[round % sample_count];
        write_world(text, round % 3 == 0 ? garble_number(&random, text, s->text, s->len)
                                         : garble(&random, text, sizeof text, s->text, s->len));
        struct world_options options = {.quiet = true, .seed = 1};
        struct heard once;
        struct heard again;
        struct mu_fault first = {.text = ""};
        mu_result r = world_read(&world, path, &options, &first);
        wrong += r == MU_OK ? !is_sane(&world) : first.line < 1 || first.text[0] == '\0';
        refused += r != MU_OK;
        mu_result all = read_all(&once);
        read_all(&again);
        /* Who stops at the first mistake and who hears of all agree on whether there is one. */
        wrong += (r != MU_OK && all == MU_OK) || (all != MU_OK) != (once.mistakes > 0);
        wrong += once.placeless > 0 || once.texts != again.texts || once.mistakes != again.mistakes;
        if (wrong > 0) {
            dprintf(kept, "\nround %llu, %d %d %zu:\n%s\n", (unsigned long long)round, r, all,
                    once.mistakes, text);
        }
    }
    unhush(kept);
    CU_ASSERT_EQUAL(wrong, 0);
    CU_ASSERT(refused > rounds / 10 && refused < rounds);
}

static void test_the_corpus_itself(void)
{
    static const size_t mistakes[] = {0, 0, 1, 0}; /* in the order of the alphabet; 1: some */
    CU_ASSERT_EQUAL_FATAL(sample_count, sizeof mistakes / sizeof mistakes[0]);
    for (size_t i = 0; i < sample_count; i++) {
        struct heard heard;
        write_world(samples[i].text, samples[i].len);
        mu_result r = read_all(&heard);
        CU_ASSERT_EQUAL(r == MU_OK, mistakes[i] == 0);
        CU_ASSERT_EQUAL(heard.mistakes > 0, mistakes[i] > 0);
    }
}

/* Definitions that double, heard to the end: what passes a limit ends the work all the same. */
static void test_a_listener_does_not_outlive_a_limit(void)
{
    static const char *const kinds[] = {"model", "position"};
    static char text[8192];
    for (size_t kind = 0; kind < 2; kind++) {
        size_t len = (size_t)snprintf(text, sizeof text, "define m0 model ( )\n");
        for (int i = 1; i <= 30; i++) {
            len += (size_t)snprintf(text + len, sizeof text - len,
                                    "define m%d model ( m%d ( ) m%d ( ) )\n", i, i - 1, i - 1);
        }
        len +=
            (size_t)snprintf(text + len, sizeof text - len, "%s ( m30 ( ) m30 ( ) )", kinds[kind]);
        write_world(text, len);
        struct heard heard;
        CU_ASSERT_EQUAL(read_all(&heard), MU_FAULT_FILE);
        CU_ASSERT(heard.mistakes >= 1);
    }
}

static void open_once(void)
{
    FILE *file = fopen(path, "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    fclose(file);
    CU_ASSERT_EQUAL(world_open(&world, path, &(struct world_options){0}, &fault), MU_OK);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"an empty file", open_once},
        {"the corpus itself", test_the_corpus_itself},
        {"a listener does not outlive a limit", test_a_listener_does_not_outlive_a_limit},
        {"wounded files", test_wounded_files},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"world/garbage", begin, end, NULL, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
