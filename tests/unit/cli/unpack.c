/* SPDX-License-Identifier: Apache-2.0 */
/* The files of a recording come out of it where they stood, and never anywhere else. */
#include "cli/unpack.h"
#include "capture.h"
#include "mcap/mcap.h"
#include "suite.h"

#include <ftw.h>
#include <stdlib.h>
#include <sys/stat.h>

static char home[] = "/tmp/unpack-XXXXXX"; /* stands for /tmp */
static char path[sizeof home + 16];
static struct mcap_writer *writer;
static struct mcap_reader *reader;
static struct unpacked unpacked;

static int begin(void)
{
    writer = mcap_writer_create();
    reader = mcap_reader_create();
    if (!mkdtemp(home)) {
        return 1;
    }
    snprintf(path, sizeof path, "%s/run.mcap", home);
    return setenv("TMPDIR", home, 1);
}

static int entry_remove(const char *entry, const struct stat *is, int kind, struct FTW *place)
{
    (void)is;
    (void)kind;
    (void)place;
    return remove(entry);
}

static int end(void)
{
    mcap_reader_close(reader);
    return nftw(home, entry_remove, 8, FTW_DEPTH | FTW_PHYS);
}

/* Unpacks a recording that was made in a folder, and has files of these names, each in itself. */
static mu_result unpack(const char *folder, const char *const names[], bool keeps)
{
    struct mu_fault fault;
    const struct mcap_pair about[] = {{"folder", folder}};
    CU_ASSERT_EQUAL_FATAL(mcap_writer_open(writer, path, "test"), MU_OK);
    (void)mcap_writer_metadata(writer, "run", about, 1);
    for (size_t i = 0; names[i]; i++) {
        CU_ASSERT_EQUAL(
            mcap_writer_attach(writer, names[i], "text/plain", names[i], strlen(names[i])), MU_OK);
    }
    CU_ASSERT_EQUAL_FATAL(mcap_writer_close(writer), MU_OK);
    CU_ASSERT_EQUAL_FATAL(mcap_reader_open(reader, path, &fault), MU_OK);
    capture_begin();
    mu_result opened = unpack_open(&unpacked, reader, path, keeps);
    capture_end();
    return opened;
}

/* @return whether a file lies there below the folder, and says this */
static bool lies(const char *where, const char *wanted)
{
    char file[UNPACK_FOLDER_MAX + 128], text[128] = "";
    snprintf(file, sizeof file, "%s/%s", unpacked.folder, where);
    FILE *f = fopen(file, "r");
    size_t got = f ? fread(text, 1, sizeof text - 1, f) : 0;
    return f && fclose(f) == 0 && got == strlen(wanted) && strcmp(text, wanted) == 0;
}

static void test_where_files_lie(void)
{
    static const char *const names[] = {"experiment/a \"b\" 'c'=d.yaml", "world/_/w/x.world",
                                        "rules/v1..2/a...clp", "library/wander.clp", NULL};
    CU_ASSERT_EQUAL_FATAL(unpack("/home/me..you", names, false), MU_OK);
    CU_ASSERT(lies("files/home/me..you/a \"b\" 'c'=d.yaml", names[0]));
    CU_ASSERT(lies("files/w/x.world", names[1]));
    CU_ASSERT(lies("files/home/me..you/v1..2/a...clp", names[2]));
    CU_ASSERT(lies("library/wander.clp", names[3]));
    CU_ASSERT_EQUAL(strncmp(unpacked.folder, home, strlen(home)), 0);
    READS(unpack_path(&unpacked, unpacked.experiment), "/home/me..you/a \"b\" 'c'=d.yaml");
    unpack_close(&unpacked);
    CU_ASSERT_NOT_EQUAL(access(unpacked.folder, F_OK), 0);
}

static void test_names_that_are_none(void)
{
    static char folder_of_256[] = "world/", name_256[sizeof folder_of_256 + 256];
    memset(name_256, 'x', sizeof name_256 - 1);
    memcpy(name_256, folder_of_256, strlen(folder_of_256));
    const char *const cases[] = {
        "experiment",
        "experiment/",
        "experiment//a",
        "/etc/passwd",
        "experiment/../a",
        "experiment/./a",
        "experiment/a/",
        "experiment/a/.",
        "../a",
        "world/_/../../a",
        "library/../../a",
        "library/",
        name_256,
        "",
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const char *const names[] = {"experiment/good.yaml", cases[i], NULL};
        CU_ASSERT_EQUAL(unpack("/home", names, false), MU_FAULT_FILE);
        CU_ASSERT(said("expected files of a run"));
        unpack_close(&unpacked);
    }
}

static void test_names_that_are_taken(void)
{
    static const char *const cases[][3] = {{"experiment/a", "world/a", NULL},
                                           {"experiment/a", "world/a/b", NULL},
                                           {"experiment/a/b", "world/a", NULL}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        CU_ASSERT_EQUAL(unpack("/home", cases[i], false), MU_FAULT_FILE);
        CU_ASSERT(said(cases[i][1]));
        unpack_close(&unpacked);
    }
}

static void test_folders_that_are_none(void)
{
    static const char *const folders[] = {"home", "/home/../me", "/home//me", "/home/", "/.", "//"};
    static const char *const names[] = {"experiment/a.yaml", NULL};
    for (size_t i = 0; i < sizeof folders / sizeof folders[0]; i++) {
        CU_ASSERT_EQUAL(unpack(folders[i], names, false), MU_FAULT_FILE);
        unpack_close(&unpacked);
    }
}

static void test_no_experiment(void)
{
    static const char *const names[] = {"world/a.world", "world/b.inc", NULL};
    CU_ASSERT_EQUAL(unpack("/home", names, false), MU_OK);
    CU_ASSERT_STRING_EQUAL(unpacked.experiment, "");
    CU_ASSERT_STRING_EQUAL(unpacked.world + strlen(unpacked.folder), "/files/home/a.world");
    unpack_close(&unpacked);
}

static void test_what_is_kept(void)
{
    static const char *const names[] = {"experiment/a.yaml", NULL};
    CU_ASSERT_EQUAL(unpack("/home", names, true), MU_OK);
    unpack_close(&unpacked);
    CU_ASSERT(lies("files/home/a.yaml", names[0]));
}

static void test_no_room(void)
{
    static const char *const names[] = {"experiment/a.yaml", NULL};
    setenv("TMPDIR", "/nowhere/at/all", 1);
    CU_ASSERT_EQUAL(unpack("/home", names, false), MU_FAULT_OS);
    CU_ASSERT(said("/nowhere/at/all") && said("TMPDIR=DIR takes another folder"));
    unpack_close(&unpacked);
    setenv("TMPDIR", home, 1);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"where files lie", test_where_files_lie},
        {"names that are none", test_names_that_are_none},
        {"names that are taken", test_names_that_are_taken},
        {"folders that are none", test_folders_that_are_none},
        {"no experiment", test_no_experiment},
        {"what is kept", test_what_is_kept},
        {"no room", test_no_room},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"cli/unpack", begin, end, NULL, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
