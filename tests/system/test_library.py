# SPDX-License-Identifier: Apache-2.0
"""The library as a stranger has it: what it exports, a program outside the tree, the examples."""
import os
import re
import shutil
import signal
import subprocess
import sys

from support import (BUILD, MUSTER, ROOT, Processes, Skip, broker_start, check, check_equal, folder,
                     members, muster, new_domain, program, wait_for)

TEXT_BYTES_MAX = 116 * 1024

# A name of its own that the library has inside, too, and a kind in a layer that nothing knows of.
STRANGE = r"""
#include <muster/muster.h>
#include <stdio.h>
#include <stdlib.h>

int bus_open(void);
int bus_open(void) { return 42; }

static enum mu_take count(void *self, mu_agent *a, const struct mu_mail *mail)
{
    char content[32];
    snprintf(content, sizeof content, "%d %s", bus_open(), mail->content);
    return mu_agent_reply(a, mail, "tell", content) == MU_OK ? MU_TAKEN : MU_DECLINE;
}
static void run(void *self, mu_agent *a) { puts("runs"); fflush(stdout); }
static void dispose(void *self, mu_agent *a) { puts("disposed"); fflush(stdout); }
static const struct mu_layer_handler handlers[] = {{1000, "count", count}, {0}};
static const struct mu_agent_kind strange = {
    .name = "strange", .handlers = handlers,
    .hooks = {[MU_ON_RUN] = run, [MU_ON_DISPOSE] = dispose}};

int main(int argc, char **argv)
{
    struct mu_process_options options = {.domain = atoi(argv[1])};
    struct mu_handlers nothing = {0};
    mu_process *p = NULL;
    mu_agent *a;
    int failed = mu_process_open(&p, &options) != MU_OK ||
                 mu_agent_join(p, &a, "strange", MU_KIND_AGENT, 0, &nothing) != MU_OK;
    if (!failed) {
        mu_agent_be(a, &strange);
        mu_memory_seal();
        failed = mu_process_run(p) != MU_OK;
    }
    mu_process_close(p);
    return failed;
}
"""


def output_of(*words, **kwargs):
    return subprocess.run([str(w) for w in words], check=True, capture_output=True, text=True,
                          timeout=60, **kwargs).stdout


def declared():
    """What the headers that muster.h includes declare."""
    names = set()
    for header in re.findall(r'^#include "(muster/\w+\.h)"',
                             (ROOT / "include/muster/muster.h").read_text(), re.M):
        text = re.sub(r"/\*.*?\*/", "", (ROOT / "include" / header).read_text(), flags=re.S)
        text = re.sub(r"^#.*(\\\n.*)*$", "", text, flags=re.M)
        names |= set(re.findall(r"(mu_\w+)\([^;{]*\);", text))
        names |= set(re.findall(r"^extern .*?(mu_\w+);", text, re.M))
    return names


def test_the_libraries_export_what_the_headers_declare():
    wanted = declared()
    check(len(wanted) >= 30, f"declared: {sorted(wanted)}")
    shared = {line.split()[-1]
              for line in output_of("nm", "-D", "--defined-only",
                                    BUILD / "libmuster.so.0").splitlines()}
    if BUILD.name == "release":
        exported = {name.split("@")[0] for name in shared if name != "MUSTER_0"}
        check_equal(sorted(exported - wanted), [], "exported without being declared")
        check_equal(sorted(wanted - exported), [], "declared without being exported")
        check(all("@@MUSTER_0" in name for name in shared if name.startswith("mu_")), shared)
        static = {line.split()[-1]
                  for line in output_of("nm", "-g", "--defined-only",
                                        BUILD / "libmuster.a").splitlines()
                  if len(line.split()) == 3}
        check_equal(sorted(static), sorted(exported), "what the static library exports")
    for name in wanted:
        check(f"{name}@@MUSTER_0" in shared, f"{name} is not exported")


def test_the_libraries_are_small_and_need_little():
    dynamic = output_of("readelf", "-d", BUILD / "libmuster.so.0")
    check("[libmuster.so.0]" in dynamic, dynamic)
    needed = re.findall(r"NEEDED.*\[(lib\w+)", dynamic)
    check("libddsc" in needed, f"it needs {needed}")
    check(not {"libclips", "libode", "libccd", "libpng16"} & set(needed), f"it needs {needed}")
    if BUILD.name == "release":
        for library in ("libmuster.so.0", "libmuster.a"):  # code, constants and tables
            text = int(output_of("size", BUILD / library).splitlines()[1].split()[0])
            check(10000 < text <= TEXT_BYTES_MAX, f"{library} has {text} bytes of text")


def install(out):
    """An installed copy; gives the environment in which pkg-config finds it."""
    if not shutil.which("pkg-config"):
        raise Skip("no pkg-config: package pkg-config")
    output_of("make", "-s", "DEPS=skip", "install", f"BUILD={BUILD.name}", f"DESTDIR={out}",
              "PREFIX=/usr", cwd=ROOT)
    return {**os.environ, "PKG_CONFIG_PATH": str(out / "usr/lib/pkgconfig"),
            "PKG_CONFIG_SYSROOT_DIR": str(out), "LD_LIBRARY_PATH": str(out / "usr/lib")}


def build(source, target, environment, static, compiler="gcc"):
    """Builds a program as the how-to says."""
    flags = output_of("pkg-config", "--cflags", "--libs", "muster", env=environment).split()
    if static:
        root = environment["PKG_CONFIG_SYSROOT_DIR"]
        private = output_of("pkg-config", "--static", "--libs-only-l", "muster",
                            env=environment).split()
        flags = [*output_of("pkg-config", "--cflags", "muster", env=environment).split(),
                 f"{root}/usr/lib/libmuster.a", *private[1:]]
    sanitize = ["-fsanitize=address,undefined"] if BUILD.name == "asan" else []
    strict = ["-Wall", "-Wextra", "-Wno-unused-parameter", "-Wpedantic", "-Wconversion", "-Wshadow",
              "-Werror"]
    built = subprocess.run([compiler, *strict, "-o", str(target), str(source), *flags, *sanitize],
                           capture_output=True, text=True, cwd=target.parent)
    check_equal(built.returncode, 0, f"a build of {source.name}: {built.stderr}")


def ask(domain, *words):
    done = subprocess.run([program("ask"), str(domain), *map(str, words)], capture_output=True,
                          text=True, timeout=30)
    check_equal(done.returncode, 0, f"an answer to {words}: {done.stdout}{done.stderr}")
    return done.stdout.strip()


def is_gone(domain, name):
    """Of one that is disposed of: it is absent, and soon its name ends."""
    return members(domain).get(name, {"state": "absent"})["state"] == "absent"


def stranger_lives(out, environment, static):
    target = out / ("static" if static else "shared")
    build(out / "strange.c", target, environment, static)
    libraries = output_of("ldd", target, env=environment)
    check_equal("libmuster.so.0" in libraries, not static, f"linked with {libraries}")
    check("libclips" not in libraries and "libode" not in libraries, libraries)
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        with (out / "said").open("w") as said:
            stranger = processes.start(target, domain, env=environment, stdout=said)
        wait_for(lambda: "strange" in members(domain), 10, "the stranger in the white pages")
        if shutil.which("ss"):
            sockets = [line for line in output_of("ss", "-Hanup").splitlines()
                       if f"pid={stranger.pid}," in line]
            check(sockets, "sockets of the stranger")
            for line in sockets:
                check(re.match(r"127.0.0.1(%lo)?:|0.0.0.0%lo:", line.split()[3]), f"bound to {line}")
        check_equal(ask(domain, "strange", 1000, "count", "sheep"),
                    "1000 strange talk tell: 42 sheep", "a layer of its own")
        check_equal(ask(domain, "strange", 1, "dispose"), "1 strange talk agree: dispose",
                    "a request of the system layer")
        wait_for(lambda: is_gone(domain, "strange"), 5, "its absence")
        check_equal((out / "said").read_text(), "runs\ndisposed\n", "its hooks")


def test_a_strange_program_is_built_and_lives_with_either_library():
    with folder() as out:
        environment = install(out)
        headers = {p.name for p in (out / "usr/include/muster").iterdir()}
        check_equal(headers, {p.name for p in (ROOT / "include/muster").iterdir()}, "headers")
        check_equal(os.readlink(out / "usr/lib/libmuster.so"), "libmuster.so.0", "the link")
        (out / "strange.c").write_text(STRANGE)
        stranger_lives(out, environment, static=False)
        stranger_lives(out, environment, static=True)


def test_an_installed_muster_finds_its_experiments():
    with folder() as out:
        install(out)
        done = subprocess.run([out / "usr/bin/muster", "run", "follow", "--duration", "0.2",
                               "--quiet", "--domain", str(new_domain())], cwd=out, timeout=60,
                              capture_output=True, text=True)
        check_equal(done.returncode, 0, done.stderr)
        check((out / "out/follow-1/report.html").exists(), "its report")


# As every binding does it.  A socket of the program's own is left alone.
DYNAMIC = """
import ctypes, socket, sys
class Options(ctypes.Structure):
    _fields_ = [("domain", ctypes.c_int), ("interface", ctypes.c_char_p), ("peer", ctypes.c_char_p),
                ("name", ctypes.c_char_p), ("with_body", ctypes.c_bool), ("watches", ctypes.c_bool),
                ("agents", ctypes.c_uint32), ("outbox", ctypes.c_uint32),
                ("broker", ctypes.c_char_p)]
own = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
own.bind(("0.0.0.0", 0))
library, process = ctypes.CDLL(sys.argv[1]), ctypes.c_void_p()
options = Options(domain=int(sys.argv[2]))
print(library.mu_process_open(ctypes.byref(process), ctypes.byref(options)), own.getsockname()[1], flush=True)
sys.stdin.read()
"""


def test_a_program_that_loads_the_library_listens_on_loopback_alone():
    if not shutil.which("ss"):
        raise Skip("no ss: package iproute2")
    if BUILD.name == "asan":
        raise Skip("a library with sanitizers is not loaded into a program without")
    with Processes() as processes:
        p = processes.start(sys.executable, "-c", DYNAMIC, BUILD / "libmuster.so.0", new_domain(),
                            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        opened, own = map(int, p.stdout.readline().split())
        check_equal(opened, 0, "it is in a domain")
        lines = [line.split()[3] for line in output_of("ss", "-Hulnp").splitlines()
                 if f"pid={p.pid}," in line]
        theirs = [a for a in lines if not a.endswith(f":{own}")]
        check(len(theirs) >= 1, lines)
        check(all(re.match(r"127.0.0.1(%lo)?:|0.0.0.0%lo:", a) for a in theirs), lines)
        check(f"0.0.0.0:{own}" in lines, f"its own socket: {lines}")


def test_a_program_in_cpp_takes_the_headers():
    if not shutil.which("g++"):
        raise Skip("no compiler for C++: package g++")
    with folder() as out:
        environment = install(out)
        (out / "plus.cc").write_text(
            "#include <muster/muster.h>\n"
            "int main() { return mu_result_text(MU_OK)[0] == 'o' ? 0 : 1; }\n")
        build(out / "plus.cc", out / "plus", environment, static=False, compiler="g++")
        done = subprocess.run([out / "plus"], env=environment, timeout=10)
        check_equal(done.returncode, 0, "a call of the library")


def test_the_library_takes_no_memory_after_joining():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        done = subprocess.run([program("memory_counter"), str(domain), "1000"],
                              capture_output=True, text=True, timeout=60)
        check_equal((done.returncode, done.stdout.strip()), (0, "1000 mails, 0 calls"),
                    f"calls of an allocator: {done.stderr}")


def test_what_handlers_must_not_do_is_refused():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        done = subprocess.run([program("misuser"), str(domain)], capture_output=True, text=True,
                              timeout=60)
        check_equal((done.returncode, done.stdout), (0, "20 mails, 20 times busy\n"),
                    f"handlers that spin: {done.stderr}")
        done = subprocess.run([program("misuser"), str(domain), "close"], capture_output=True,
                              text=True, timeout=60)
        check_equal(done.returncode, -signal.SIGABRT, "a handler that closes its process")
        check("mu_process_close" in done.stderr, f"what is wrong with it: {done.stderr}")


def example_start(processes, domain, name, *words):
    return processes.start(BUILD / "examples" / name, *words, domain)


def test_examples_are_short():
    for name, most in (("spin", 40), ("time_server", 25)):
        lines = len((ROOT / f"examples/{name}.c").read_text().splitlines())
        check(lines <= most, f"examples/{name}.c has {lines} lines")


def test_the_time_server_and_the_robot():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        server = example_start(processes, domain, "time_server")
        robot = example_start(processes, domain, "spin", "red")
        wait_for(lambda: {"clock", "red"} <= set(members(domain)), 10, "both in the white pages")
        check("3 clock talk inform: " in ask(domain, "clock", 3, "request", "time"), "the time")
        check_equal(members(domain)["red"]["state"], "standby", "a robot that waits")
        check_equal(muster("start", "red", "--domain", domain).returncode, 0, "a directive")
        wait_for(lambda: members(domain)["red"]["state"] == "running", 5, "a robot that runs")
        check_equal(ask(domain, "red", 3, "tell", "hello"), "3 red talk not-understood: tell",
                    "a robot without ears")
        for p in (server, robot):
            p.terminate()
            check_equal(p.wait(30), 0, "the end of an example")
        check_equal(members(domain)["clock"]["state"], "absent", "the server after its end")


# What both kinds of examples/kinds.c answer, in C and in rules.
KINDS = ((("shop", 4, "cfp"), "4 shop talk propose: price 10"),
         (("thrifty", 4, "cfp", "20"), "4 thrifty talk propose: price 7"),
         (("thrifty", 4, "cfp"), "4 thrifty talk propose: price 10"),
         (("thrifty", 4, "give-back"), "4 thrifty talk refuse: give-back"),
         (("thrifty", 5, "cfp"), "5 thrifty talk not-understood: cfp"),
         (("thrifty", 1, "dispose"), "1 thrifty talk refuse: dispose"),
         (("shop", 2, "state"), "2 shop talk inform: state running"))
# What those in C answer alone.
KINDS_C = ((("thrifty", 4, "dance"), "4 thrifty talk not-understood: dance"),
           (("shop", 1, "clone"), "1 shop talk refuse: clone no-mobility"))


def kinds_check(domain, answers):
    """Both shops are there, and answer so; one lets itself be disposed of."""
    wait_for(lambda: {"shop", "thrifty"} <= set(members(domain)), 10, "both shops")
    for words, answer in (*answers, (("shop", 1, "dispose"), "1 shop talk agree: dispose")):
        check_equal(ask(domain, *words), answer, f"the answer to {words}")
    wait_for(lambda: is_gone(domain, "shop"), 5, "a shop that is gone")
    check_equal(members(domain)["thrifty"]["state"], "running", "the other one")


def test_the_example_of_kinds():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        example_start(processes, domain, "kinds")
        kinds_check(domain, KINDS + KINDS_C)


def test_the_same_kinds_in_rules():
    """The rule files beside the example answer as the example does."""
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        for name in ("shop", "thrifty"):
            processes.start(MUSTER, "agent", name, "--rules", ROOT / f"examples/kinds_{name}.clp", "--domain", domain)
        kinds_check(domain, KINDS)


def test_the_example_of_groups_and_services():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        with (out / "said").open("w") as said:
            processes.start(BUILD / "examples/services", domain, stdout=said)
        wait_for((out / "said").read_text, 10, "an answer from who offers the service")
        check_equal((out / "said").read_text(), "adder says: sum 42\n", "the answer")
        for question, answer in (("groups", "groups arithmetic"), ("services", "services sum")):
            check_equal(ask(domain, "adder", 2, question), f"2 adder talk inform: {answer}",
                        f"the answer to {question}")


def test_a_domain_of_the_environment_that_is_none():
    for domain in ("abc", "-1", "231", "7x"):
        environment = {**os.environ, "MUSTER_DOMAIN": domain}
        done = subprocess.run([BUILD / "examples" / "kinds", "0"], env=environment, capture_output=True, text=True,
                              timeout=20, check=False)
        check(done.returncode != 0, domain)
        check_equal(done.stderr, f"MUSTER_DOMAIN={domain}: expected a whole number from 0 to 230\n", domain)


# Says that its struct number I of OPENER has SIZE bytes more than in its headers.  The last member of number 0 is wrong.
OTHER = r"""
#include <muster/muster.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv)
{
    struct mu_process_options options = {.domain = atoi(argv[1]), .broker = atoi(argv[3]) == 0 ? "no name" : NULL};
    struct mu_watch_options watch_options = {.domain = atoi(argv[1])};
    uint32_t sizes[16] = {0};
    mu_process *p = NULL;
    mu_watch *w = NULL;
    mu_agent *a;
    char opener = argv[2][0];
    const uint32_t *own = opener == 'p' ? mu_process_sizes() : opener == 'w' ? mu_watch_sizes() : mu_stats_sizes();
    for (int i = 0; own[i] > 0; i++) {
        sizes[i] = own[i];
    }
    sizes[atoi(argv[3])] += (uint32_t)atoi(argv[4]);
    if (opener == 'w') {
        return mu_watch_open_built(&w, NULL, &watch_options, "0.0.9", sizes) == MU_OK ? 0 : 3;
    }
    if (opener == 's') {
        return mu_stats_open_built("0.0.9", sizes) ? 0 : 3;
    }
    if (mu_process_open_built(&p, &options, "0.0.9", sizes) != MU_OK) {
        return 3;
    }
    puts(mu_agent_join(p, &a, "older", MU_KIND_AGENT, 0, NULL) == MU_OK ? mu_version() : "no");
    fflush(stdout);
    mu_result run = mu_process_await_broker(p, 5000000000);
    mu_process_close(p);
    return run == MU_OK ? 0 : 4;
}
"""


def shared_structs():
    """The structs that each opener compares, in its order."""
    text = "".join(p.read_text() for p in sorted((ROOT / "include/muster").glob("*.h")))
    functions = re.findall(r"mu_(\w+)_sizes\(void\)\n\{(.*?)\n\}", text, re.S)
    return {opener: re.findall(r"sizeof\(struct (\w+)\)", body) for opener, body in functions}


def test_each_public_struct_is_compared_by_an_opener():
    text = "".join(p.read_text() for p in (ROOT / "include/muster").glob("*.h"))
    defined = set(re.findall(r"^struct (mu_\w+) \{", text, re.M))
    compared = {name for names in shared_structs().values() for name in names}
    check(len(defined) > 20, defined)
    # The last member of mu_watch_options.
    check_equal(sorted(defined - compared), ["mu_watch_handlers"], "structs whose size no opener compares")


def test_a_program_of_other_headers_works_or_is_refused_with_a_word():
    with folder() as out, Processes() as processes:
        environment = install(out)
        (out / "other.c").write_text(OTHER)
        build(out / "other.c", out / "other", environment, static=False)
        domain = new_domain()
        broker_start(processes, domain)

        def other(opener, struct, more):
            done = subprocess.run([out / "other", str(domain), opener, str(struct), str(more)],
                                  env=environment, capture_output=True, text=True, timeout=30)
            return done.returncode, done.stdout, done.stderr

        version = re.search(r'MU_VERSION +"(.*)"',
                            (ROOT / "include/muster/version.h").read_text())[1]
        sizes = shared_structs()
        for opener, name in (("process", "mu_process_options"), ("process", "mu_member"), ("watch", "mu_run_result"),
                             ("stats", "mu_stats_robot")):
            said = f"{version}\n" if opener == "process" else ""
            check_equal(other(opener, sizes[opener].index(name), -8), (0, said, ""), f"a {name} without its last member")
        for opener, name, more in (("process", "mu_process_options", 8), ("process", "mu_mail", -8),
                                   ("process", "mu_agent_kind", -8), ("watch", "mu_frame", 8), ("stats", "mu_stats_team", 8)):
            code, said, words = other(opener, sizes[opener].index(name), more)
            check_equal((code, said), (3, ""), "a program that does not fit")
            check(f"built with muster 0.0.9, where struct {name} has " in words, words)
