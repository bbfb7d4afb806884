/* SPDX-License-Identifier: Apache-2.0 */
/* What a run's recording says of how the run was made; the run itself is in tests/system. */
#include "capture.h"
#include "mcap/mcap.h"
#include "muster/version.h"
#include "sim/record/record.h"
#include "suite.h"

#include <stdlib.h>
#include <unistd.h>

static char folder[] = "/tmp/muster-mcap-XXXXXX";
static char path[64], made[64];
static struct mcap_reader *r;

static int begin(void)
{
    r = mcap_reader_create();
    if (!mkdtemp(folder)) {
        return 1;
    }
    snprintf(path, sizeof path, "%s/run.mcap", folder);
    snprintf(made, sizeof made, "%s/a.world", folder);
    FILE *file = fopen(made, "w");
    fputs("a world", file);
    return fclose(file);
}

static int end(void)
{
    mcap_reader_close(r);
    unlink(path);
    unlink(made);
    return rmdir(folder);
}

/* Writes a recording with these files and notes, and opens it. */
static void recording_make(struct mu_option_list *files, struct mu_option_list *notes)
{
    static struct mcap_file *all[16]; /* kept, so that leak checkers see them */
    static size_t count;
    struct mu_fault fault;
    struct mcap_file_options options = {.path = path, .files = files, .notes = notes};
    CU_ASSERT_EQUAL_FATAL(mcap_file_open(&all[count], &options), MU_OK);
    CU_ASSERT_EQUAL_FATAL(mcap_file_close(all[count++]), MU_OK);
    CU_ASSERT_EQUAL_FATAL(mcap_reader_open(r, path, &fault), MU_OK);
}

static void test_notes(void)
{
    static struct mu_option_list files, notes = {{"seed=7", "command=a --set b=c", "nothing"}, 3};
    recording_make(&files, &notes);
    READS(mcap_reader_value(r, "run", "seed"), "7");
    READS(mcap_reader_value(r, "run", "command"), "a --set b=c");
    CU_ASSERT_PTR_NULL(mcap_reader_value(r, "run", "nothing"));
    READS(mcap_reader_value(r, "run", "muster"), MU_VERSION);
    CU_ASSERT_PTR_NOT_NULL(mcap_reader_value(r, "run", "ode"));
    READS(mcap_reader_table(r, 0)->name, "run");
}

/* No name leads out of a folder. */
static void test_names_of_files(void)
{
    static const struct {
        const char *name, *wanted;
    } cases[] = {
        {"world/a.world", "world/a.world"},
        {"world//x/a.world", "world/x/a.world"},
        {"/etc/passwd", "etc/passwd"},
        {"../../etc/passwd", "etc/passwd"},
        {"world/./../../a.world", "world/a.world"},
        {"..", ""},
        {"world/v1..2/a...world", "world/v1..2/a...world"},
        {"world/a==b.world", "world/a=b.world"},
        {"world/====", "world/=="},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char word[256];
        static struct mu_option_list files, notes;
        char text[16] = "";
        snprintf(word, sizeof word, "%s=%s", cases[i].name, made);
        files.items[0] = word;
        files.count = 1;
        recording_make(&files, &notes);
        const struct mcap_attachment *a = mcap_reader_attachment(r, 0);
        CU_ASSERT_PTR_NOT_NULL_FATAL(a);
        READS(a->name, cases[i].wanted);
        CU_ASSERT_EQUAL(mcap_reader_attachment_read(r, 0, text, sizeof text), MU_OK);
        READS(text, "a world");
    }
}

static void test_a_file_that_is_not_there(void)
{
    static struct mu_option_list files = {{"world/b.world=/nowhere/b.world"}, 1}, notes;
    capture_begin();
    recording_make(&files, &notes);
    capture_end();
    CU_ASSERT_PTR_NULL(mcap_reader_attachment(r, 0));
    CU_ASSERT(said("/nowhere/b.world is not in the recording: it cannot be read"));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"notes", test_notes},
        {"names of files", test_names_of_files},
        {"a file that is not there", test_a_file_that_is_not_there},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"sim/mcap_file", begin, end, NULL, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
