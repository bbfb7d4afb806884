/* SPDX-License-Identifier: Apache-2.0 */
/* Files as text: whole, cut, with zero bytes, and those that cannot be read. */
#include "core/text_file.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char path[] = "/tmp/muster-text-XXXXXX";

static void write_file(const char *bytes, size_t len)
{
    FILE *f = fopen(path, "wb");
    CU_ASSERT_PTR_NOT_NULL_FATAL(f);
    CU_ASSERT_EQUAL(fwrite(bytes, 1, len, f), len);
    (void)fclose(f);
}

static mu_result read_file(const char *of, struct mu_text *out, size_t size)
{
    static char bytes[16];
    struct mu_fault fault;
    mu_text_init(out, bytes, size);
    return mu_text_file_read(of, out, &fault);
}

static void test_whole_and_cut(void)
{
    struct mu_text out;
    write_file("a\0bc", 4);
    CU_ASSERT_EQUAL(read_file(path, &out, 5), MU_OK);
    CU_ASSERT_EQUAL(out.len, 4);
    CU_ASSERT(!out.cut);
    CU_ASSERT_EQUAL(memcmp(out.at, "a\0bc", 5), 0);
    CU_ASSERT_EQUAL(read_file(path, &out, 4), MU_OK);
    CU_ASSERT_EQUAL(out.len, 3);
    CU_ASSERT(out.cut);
}

static void test_what_cannot_be_read(void)
{
    struct mu_text out;
    struct mu_fault fault;
    char bytes[16];
    CU_ASSERT_EQUAL(read_file("/tmp/there/is/none", &out, 8), MU_ABSENT);
    mu_text_init(&out, bytes, sizeof bytes);
    CU_ASSERT_EQUAL(mu_text_file_read("/tmp", &out, &fault), MU_FAULT_FILE);
    CU_ASSERT_STRING_EQUAL(fault.text, "cannot be read: Is a directory");
}

/* Until it is whole, a file leaves what has its name alone. */
static void test_drafts(void)
{
    struct mu_draft d;
    struct mu_fault fault;
    struct mu_text out;
    write_file("old", 3);
    for (int whole = 0; whole < 2; whole++) {
        CU_ASSERT_EQUAL_FATAL(mu_draft_open(&d, NULL, path, &fault), MU_OK);
        fputs("new", d.file);
        CU_ASSERT_EQUAL(access(d.beside, F_OK), 0);
        CU_ASSERT_EQUAL(mu_draft_close(&d, whole, &fault), MU_OK);
        CU_ASSERT_NOT_EQUAL(access(d.beside, F_OK), 0);
        CU_ASSERT_EQUAL(read_file(path, &out, 8), MU_OK);
        CU_ASSERT_STRING_EQUAL(out.at, whole ? "new" : "old");
    }
}

static void test_drafts_that_fail(void)
{
    struct mu_draft d;
    struct mu_fault fault;
    CU_ASSERT_EQUAL(mu_draft_open(&d, "/tmp/there/is", "none", &fault), MU_FAULT_OS);
    CU_ASSERT_STRING_EQUAL(fault.file, "/tmp/there/is/none");
    CU_ASSERT_STRING_EQUAL(fault.text, "cannot write: No such file or directory");
    CU_ASSERT_EQUAL_FATAL(mu_draft_open(&d, "/dev", "full", &fault), MU_OK);
    CU_ASSERT_STRING_EQUAL(d.beside, "");
    fputs("new", d.file);
    CU_ASSERT_EQUAL(mu_draft_close(&d, true, &fault), MU_FAULT_OS);
    CU_ASSERT_STRING_EQUAL(fault.text, "cannot write: No space left on device");
}

int main(void)
{
    int file = mkstemp(path);
    if (file < 0) {
        return EXIT_FAILURE;
    }
    (void)close(file);
    CU_TestInfo tests[] = {
        {"whole and cut", test_whole_and_cut},
        {"what cannot be read", test_what_cannot_be_read},
        {"drafts", test_drafts},
        {"drafts that fail", test_drafts_that_fail},
        CU_TEST_INFO_NULL,
    };
    int code = suite_run("core/text_file", tests);
    (void)unlink(path);
    return code;
}
