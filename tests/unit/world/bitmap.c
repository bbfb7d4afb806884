/* SPDX-License-Identifier: Apache-2.0 */
/* Damaged pictures, and the rectangles that a picture is taken apart into. */
#include "garble.h"
#include "suite.h"
#include "world/parse/parser.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static struct world_file memory; /* static: leak checkers see it */
static char path[] = "/tmp/muster-picture-XXXXXX";

static const char *read_bytes(struct bitmap *bitmap, const char *bytes, size_t len)
{
    FILE *file = fopen(path, "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    CU_ASSERT_EQUAL(fwrite(bytes, 1, len, file), len);
    CU_ASSERT_EQUAL(fclose(file), 0);
    memory.bytes_used = 0;
    static const struct bitmap_rule rule = {.threshold = BITMAP_THRESHOLD};
    return bitmap_read(bitmap, path, &rule, &memory);
}

/* Takes all rectangles.  @return whether each solid pixel was in exactly one, and no other was */
static bool taken_apart(struct bitmap *bitmap)
{
    enum { PIXELS_MAX = 1 << 16 };
    static unsigned char before[PIXELS_MAX];
    size_t pixels = (size_t)bitmap->width * (size_t)bitmap->height;
    if (pixels > PIXELS_MAX) {
        return true;
    }
    memcpy(before, bitmap->solid, pixels);
    size_t at = 0;
    bool whole = true;
    for (struct bitmap_rectangle r; bitmap_take_rectangle(bitmap, &at, &r);) {
        whole = whole && r.width > 0 && r.height > 0 && r.x >= 0 && r.y >= 0 &&
                r.x + r.width <= bitmap->width && r.y + r.height <= bitmap->height;
        for (int i = 0; whole && i < r.width * r.height; i++) {
            size_t pixel =
                (size_t)(r.y + i / r.width) * (size_t)bitmap->width + (size_t)(r.x + i % r.width);
            whole = before[pixel] == 1;
            before[pixel] = 2;
        }
    }
    return whole && !memchr(before, 1, pixels);
}

static void test_random_pictures_are_taken_apart(void)
{
    enum { SEED = 31, ROUNDS = 300 };
    struct mu_random r;
    mu_random_seed(&r, SEED, "pictures");
    printf("seed %d ", SEED);
    for (int round = 0; round < ROUNDS; round++) {
        char text[2048];
        struct bitmap bitmap;
        int width = (int)mu_random_between(&r, 1, 40);
        int height = (int)mu_random_between(&r, 1, 40);
        size_t len = (size_t)snprintf(text, sizeof text, "P1 %d %d\n", width, height);
        int64_t density = mu_random_between(&r, 1, 9);
        for (int i = 0; i < width * height; i++) {
            text[len++] = mu_random_between(&r, 0, 9) < density ? '1' : '0';
        }
        CU_ASSERT_PTR_NULL_FATAL(read_bytes(&bitmap, text, len));
        CU_ASSERT(bitmap.width == width && bitmap.height == height);
        CU_ASSERT_TRUE(taken_apart(&bitmap));
    }
}

static const struct sample {
    const char *bytes;
    size_t len;
} samples[] = {
#define SAMPLE(bytes)            \
    {                            \
        bytes, sizeof(bytes) - 1 \
    }
    SAMPLE("P1 # plain\n4 2\n1100\n0001\n"),
    SAMPLE("P2\n4 2 10\n0 0 10 10 10 10 10 0\n"),
    SAMPLE("P4\n4 2\n\xc0\x10"),
    SAMPLE("P5\n4 2\n255\n\x01\x01\xff\xff\xff\xff\xff\x01"),
    SAMPLE("P5 4 2 256\n\1\1\1\1\1\2\1\3\1\4\1\5\1\1\1\2"),
    SAMPLE("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\2\0\0\0\1\b\0\0\0\0\xd1I V\0\0\0\vIDATx\x9c"
           "c`\xf8\x0f\0\1\2\1\0B\xbe\xbch\0\0\0\0IEND\xae"
           "B`\x82"),
};

/* Garbage is refused with a reason, or read; what is read has pixels of 0 and 1. */
static void test_garbage_is_refused_or_read(void)
{
    enum { SEED = 32, ROUNDS = 1500, SAMPLES = sizeof samples / sizeof samples[0] };
    struct mu_random r;
    unsigned counts[2] = {0};
    unsigned wrong = 0;
    mu_random_seed(&r, SEED, "garbage");
    printf("seed %d ", SEED);
    for (int round = 0; round < ROUNDS; round++) {
        char bytes[512];
        struct bitmap bitmap;
        const struct sample *sample = &samples[round % SAMPLES];
        size_t len = garble(&r, bytes, sizeof bytes, sample->bytes, sample->len);
        const char *problem = read_bytes(&bitmap, bytes, len);
        counts[problem == NULL]++;
        if (problem) {
            wrong += problem[0] == '\0';
            continue;
        }
        wrong += bitmap.width < 1 || bitmap.width > BITMAP_SIDE_MAX || bitmap.height < 1 ||
                 bitmap.height > BITMAP_SIDE_MAX || !taken_apart(&bitmap);
    }
    CU_ASSERT_EQUAL(wrong, 0);
    CU_ASSERT(counts[0] > ROUNDS / 10 && counts[1] > ROUNDS / 10);
}

static void test_limit_sides(void)
{
    struct bitmap bitmap;
    static const char *const large[] = {"P4 16385 1\n", "P4 1 16385\n", "P4 99999999999 1\n",
                                        "P5 1 99999999999 255\n"};
    for (size_t i = 0; i < sizeof large / sizeof large[0]; i++) {
        const char *problem = read_bytes(&bitmap, large[i], strlen(large[i]));
        CU_ASSERT_PTR_NOT_NULL_FATAL(problem);
        CU_ASSERT_STRING_EQUAL(problem, "the picture is too large");
    }
    static char widest[16384 / 8 + 32];
    size_t len = (size_t)snprintf(widest, sizeof widest, "P4 %d 1\n", BITMAP_SIDE_MAX);
    memset(widest + len, 0xff, 16384 / 8);
    CU_ASSERT_PTR_NULL_FATAL(read_bytes(&bitmap, widest, len + 16384 / 8));
    CU_ASSERT_EQUAL(bitmap.width, BITMAP_SIDE_MAX);
    CU_ASSERT_TRUE(taken_apart(&bitmap));
}

static int begin(void)
{
    worldfile_init(&memory);
    int fd = mkstemp(path);
    return fd < 0 || close(fd) != 0;
}

static int end(void)
{
    return unlink(path);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"random pictures are taken apart", test_random_pictures_are_taken_apart},
        {"garbage is refused or read", test_garbage_is_refused_or_read},
        {"limit: sides", test_limit_sides},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"world/bitmap", begin, end, NULL, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
