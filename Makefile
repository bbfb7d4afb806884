# muster - agents for teams of robots.  `make help` lists the targets.
#
# One Makefile, no recursion, no configure step.  A folder below src/ is a module: its files, and those
# of its own folders, are found, not listed.  Variants live side by side: build/release, build/asan, ...
MAKEFLAGS += --no-builtin-rules
# All cores, unless the command line says how many.
ifeq ($(MAKELEVEL),0)
MAKEFLAGS += -j$(shell nproc)
endif
SHELL := /bin/bash
.DELETE_ON_ERROR:
.SUFFIXES:
.SECONDARY:

VERSION := $(shell sed -n 's/^.define MU_VERSION  *"\(.*\)"/\1/p' include/muster/version.h)
BUILD   ?= release
PREFIX  ?= /usr/local
DESTDIR ?=
DEPS    ?= install
TEST_DEPS ?= $(DEPS)
V       ?= 0
Q       := $(if $(filter 1,$(V)),,@)
# Another architecture: the distribution's compiler for it, and a root of its own with the libraries.
CROSS   ?=
O       ?= build/$(BUILD)$(CROSS:%=-%)
SYSROOT := $(CROSS:%=build/sysroot/%)

ifneq ($(CROSS),)
CC    := $(CROSS)-gcc
else ifeq ($(origin CC),default)
CC    := gcc
endif
CXX   := $(patsubst %gcc,%g++,$(CC))
override CC  += $(SYSROOT:%=--sysroot=$(CURDIR)/%)
override CXX += $(SYSROOT:%=--sysroot=$(CURDIR)/%)
TOOL  := $(CROSS:%=%-)

# Where the compiler fuses a product and a sum, the distribution's ODE and libccd have other bits: both are
# made from the distribution's sources, too.
MACHINE := $(firstword $(subst -, ,$(CROSS)) $(shell uname -m))
FUSING  := aarch64 powerpc64le ppc64le s390x riscv64
EXACT   := $(patsubst %,build/exact/%,$(filter $(FUSING),$(MACHINE)))
# Its compiler computes with floats as with doubles, unless told otherwise; musl knows no such long double.
FLAGS_s390x      := -fexcess-precision=fast
MUSL_powerpc64le := -mlong-double-64 -mno-gnu-attribute
MUSL_ppc64le     := $(MUSL_powerpc64le)
# A long has 32 bits: files are as large as elsewhere, and readdir finds each of them.
FLAGS_arm        := -D_FILE_OFFSET_BITS=64
FLAGS_armv7l     := $(FLAGS_arm)
# What runs the programs here.
EMULATOR := $(if $(CROSS),qemu-$(patsubst powerpc64le,ppc64le,$(MACHINE))-static -L $(CURDIR)/$(SYSROOT))
CSTD  := -std=c11 -D_GNU_SOURCE
WARN  := -Wall -Wextra -Wpedantic -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wconversion \
         -Wno-sign-conversion -Wswitch-enum -Wundef -Wvla -Wpointer-arith -Wcast-qual \
         -Wwrite-strings -Wformat=2 -Wdouble-promotion -Wimplicit-fallthrough
WERROR ?= -Werror
CLIPS := build/clips
# Foreign headers are system headers: their warnings are not ours.
override CPPFLAGS += -Iinclude -Isrc -isystem $(O)/gen -isystem $(CLIPS)/core

# Under the address sanitizer CLIPS has no pools: each block is seen.
override CPPFLAGS += $(if $(filter asan,$(BUILD)),-DMEM_TABLE_SIZE=0)

# How far the compiler goes: LEVEL=-O0, -O3.
LEVEL ?= -O2

# Bit-identical runs need the same arithmetic everywhere: no fused multiply-add behind our back.
# Tables for unwinding are with the debug information alone: nothing of ours throws.
FLAGS_release  := $(LEVEL) -g -ffp-contract=off -fno-math-errno -fno-asynchronous-unwind-tables
FLAGS_asan     := -O1 -g -ffp-contract=off -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
FLAGS_coverage := -O0 -g -ffp-contract=off --coverage
ifeq ($(FLAGS_$(BUILD)),)
$(error BUILD=$(BUILD): use release, asan or coverage)
endif
# The shared library is made of the same objects as everything else; what a program does not use is
# left out of it. Without stubs for calls of other libraries: fifty pairs have 1.03 times the round trips.
SHARED  := -fPIC -fno-plt -fvisibility=hidden -ffunction-sections -fdata-sections
# What musl gives, the compiler knows nothing of: it would compute what is constant by itself, another way.
ELEMENTARY := sin cos sincos tan asin acos atan atan2 sinh cosh tanh exp expm1 log log10 pow hypot asinf acosf
NO_BUILTIN := $(addprefix -fno-builtin-,$(ELEMENTARY))
CFLAGS  += $(CSTD) $(WARN) $(WERROR) $(FLAGS_$(BUILD)) $(FLAGS_$(MACHINE)) $(NO_BUILTIN) $(SHARED) -MD -MP
LDFLAGS += $(filter -fsanitize% --coverage,$(FLAGS_$(BUILD))) -Wl,--gc-sections $(EXACT:%=-L%)

# What a folder's objects are compiled and linked with: when that changes, they are built again.
quoted = '$(subst ','\'',$(1))'
$(O)/flags: FLAGS := $(CC) $(CPPFLAGS) $(CFLAGS) $(LDFLAGS)
%/flags: FORCE
	@mkdir -p $(@D)
	$(Q)echo $(call quoted,$(FLAGS)) | cmp -s - $@ || echo $(call quoted,$(FLAGS)) > $@
.PHONY: FORCE
FORCE:

# --- modules: who may use whom is checked by tools/tidy.py ---------------------------------------
CODE    := $(sort $(shell find src -name '*.c'))
objs     = $(patsubst %.c,$(O)/%.o,$(filter-out %/main.c,$(filter src/$(1)/%,$(CODE))))
IDL     := $(wildcard idl/*.idl)
OBJECTS := $(CODE:%.c=$(O)/%.o)
GEN     := $(IDL:idl/%.idl=$(O)/gen/%.o)
USES_core    :=
USES_world   := core
USES_mcap    := core
USES_bus     := core
USES_faults  := bus core
USES_stats   := core
USES_runtime := stats bus core
USES_broker  := bus core
USES_sim     := mcap world bus core
USES_planner := world core
USES_mind    := planner world core
USES_agent   := mind planner world runtime stats bus core
USES_resolver := runtime stats bus core
USES_host    := agent mind planner world runtime stats bus core
USES_monitor := agent mind planner world runtime stats bus core
USES_story   := mcap bus core
USES_record  := mcap bus core
USES_replay  := mcap bus core
USES_experiment := world core
USES_report  := experiment stats world core
USES_operator := runtime stats bus core
USES_run     := operator story mcap report experiment world runtime stats bus core
USES_worldtool := operator report experiment world runtime stats bus core
USES_cli     := run worldtool operator story mcap report experiment world runtime stats bus core
USES_web     := operator story mcap runtime stats bus core
LIBS_core    := -lm
LIBS_world   := -lccd -lpng -lm
LIBS_mcap    := -lz -lm
LIBS_bus     := -lddsc -lm
LIBS_stats   := -lm
LIBS_runtime := -lddsc -lm
LIBS_broker  := -lddsc -lsqlite3 -lm
LIBS_sim     := -lode $(if $(EXACT),-lstdc++) -lccd -lcrypto -lddsc -lz -lpng -lm
LIBS_planner := -lccd -lpng -lm
LIBS_mind    := -lccd -lpng -lm
LIBS_agent   := $(LIBS_mind) -lddsc
LIBS_resolver := -lddsc -lm
LIBS_host    := $(LIBS_agent)
LIBS_monitor := $(LIBS_agent)
LIBS_story   := -lddsc -lz -lm
LIBS_record  := -lddsc -lz -lm
LIBS_replay  := -lddsc -lz -lm
LIBS_experiment := -lyaml -lccd -lpng -lm
LIBS_report  := -ljansson -lyaml -lccd -lpng -lm
LIBS_operator := -lddsc -lm
LIBS_run     := -lz -ljansson -lyaml -lddsc -lccd -lpng -lm
LIBS_worldtool := -ljansson -lyaml -lddsc -lccd -lpng -lm
LIBS_cli     := -lz -ledit -ljansson -lyaml -lddsc -lccd -lpng -lm
LIBS_web     := -lmicrohttpd -lddsc -lz -lm
# The files of the page are part of the program: src/web/assets.c names them.
ASSETS := $(patsubst %,$(O)/%.o,$(wildcard src/web/assets/*))
module_objs   = $(foreach m,$(1) $(USES_$(1)),$(call objs,$(m))) $(if $(filter bus,$(1) $(USES_$(1))),$(GEN)) \
                $(if $(filter world,$(1) $(USES_$(1))),$(ARITHMETIC) $(CCD)) $(if $(filter sim,$(1)),$(ODE)) \
                $(if $(filter mind,$(1) $(USES_$(1))),$(CLIPS_O)/libclips.a) $(if $(filter web,$(1)),$(ASSETS))

PROGRAMS := $(addprefix $(O)/bin/,muster muster-broker muster-sim muster-robot muster-agent \
            muster-resolver muster-host muster-record muster-replay muster-web muster-monitor)
MAIN_muster        := cli
MAIN_muster-broker := broker
MAIN_muster-sim    := sim
MAIN_muster-robot  := agent
MAIN_muster-agent  := agent
MAIN_muster-resolver := resolver
MAIN_muster-host   := host
MAIN_muster-monitor := monitor
MAIN_muster-record := record
MAIN_muster-replay := replay
MAIN_muster-web    := web
FAULTS   := $(O)/lib/muster/libmuster-faults.so
EXAMPLES := $(patsubst examples/%.c,$(O)/examples/%,$(wildcard examples/*.c))
HELPERS  := $(patsubst tests/programs/%.c,$(O)/programs/%,$(wildcard tests/programs/*.c))
PRELOADS := $(patsubst tests/preload/%.c,$(O)/preload/%.so,$(wildcard tests/preload/*.c))
UNITS    := $(patsubst tests/unit/%/,$(O)/unit/%,$(wildcard tests/unit/*/))
BENCHES  := $(patsubst bench/%.c,$(O)/bench/%,$(wildcard bench/micro/*.c))
SOURCES  := $(shell find src include tests examples bench -name '*.[ch]' 2>/dev/null)
# A program that was built once is kept up to date without being asked for: a helper or a bench of before
# a change of idl/wire.idl talks another wire than the programs that it meets.
KEPT     := $(wildcard $(HELPERS) $(PRELOADS) $(BENCHES) $(O)/test/gohome)

.DEFAULT_GOAL := all
.PHONY: all
all: deps $(PROGRAMS) $(FAULTS) $(O)/libmuster.a $(O)/libmuster.so.0 $(EXAMPLES) $(KEPT) ## build the programs, the library and the examples

.PHONY: deps test-deps
deps: $(SYSROOT:%=%/whole) ## install what is missing (DEPS=skip: never touch the system)
	$(Q)DEPS=$(DEPS) tools/install-deps $(CROSS:%=--cross=%)
build/sysroot/%/whole: tools/sysroot
	$(Q)tools/sysroot $* $(@D) && touch $@
test-deps: deps ## and what the tests need (TEST_DEPS=skip: what needs it is skipped)
	$(Q)DEPS=$(TEST_DEPS) tools/install-deps --tests

.SECONDEXPANSION:
$(PROGRAMS): $(O)/bin/%: $(O)/src/$$(MAIN_$$*)/main.o $$(call module_objs,$$(MAIN_$$*))
	@mkdir -p $(@D); echo "  LINK  $@"
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(LIBS_$(MAIN_$*))

# CLIPS from its source, with our patches and our port: once for all builds, and once more for the
# address sanitizer, which sees each block of it.  Its own undefined behaviour is let be: docs/clips.md.
CLIPS_O      := $(CLIPS)$(CROSS:%=/%)$(if $(filter asan,$(BUILD)),/asan)
CLIPS_CFLAGS := -std=gnu89 -w -g -ffp-contract=off $(NO_BUILTIN) -fno-strict-aliasing -fPIE -ffunction-sections -fdata-sections \
                $(if $(filter asan,$(BUILD)),-O1 -fsanitize=address -fno-omit-frame-pointer -DMEM_TABLE_SIZE=0,$(LEVEL))
PORT_ENVIRONMENT := envrnmnt
PORT_MEMORY      := memalloc
PORT_CALLS       := dffnxexe engine genrcexe msgpass
$(CLIPS)/core/whole: tools/source patches/clips $(wildcard patches/clips/*.patch) | deps
	$(Q)tools/source clips $(CLIPS) && touch $@
$(CLIPS_O)/flags: FLAGS := $(CLIPS_CFLAGS)
$(CLIPS_O)/libclips.a: $(CLIPS)/core/whole src/mind/engine/port.h $(CLIPS_O)/flags
	@mkdir -p $(@D); echo "  CC    $(CLIPS)/core/*.c"
	$(Q)ls $(CLIPS)/core/*.c | sed 's|.*/||;s|\.c$$||;/^main$$/d' | \
	  sed '$(foreach p,PORT_ENVIRONMENT PORT_MEMORY PORT_CALLS,$(foreach f,$($p),s/^$f$$/& -D$p/;))' | xargs -P $(shell nproc) -L 1 sh -c \
	  '$(CC) $(CLIPS_CFLAGS) $$1 -include src/mind/engine/port.h -c -o $(CLIPS_O)/$$0.o $(CLIPS)/core/$$0.c' && \
	  rm -f $@ && $(TOOL)ar rcs $@ $(CLIPS_O)/*.o
$(call objs,mind): CFLAGS += -fno-strict-aliasing # as it

# The elementary functions of musl, alone: the C library's choose by what the processor has.  They are
# compiled as musl compiles itself, without fused instructions, for each build.  What is in a program goes
# before what is in a library: arithmetic.o serves CLIPS and ODE, too.
MUSL := build/musl
ELEMENTARY_PARTS := __sin __cos __tan __rem_pio2 __rem_pio2_large __expo2 exp_data log_data pow_data \
                    $(addprefix __math_,divzero invalid oflow uflow xflow)
MUSL_CFLAGS := -std=c99 -w $(LEVEL) -g -ffp-contract=off -frounding-math -fexcess-precision=standard -fno-math-errno \
               -U__FP_FAST_FMA -fPIC -ffunction-sections -fdata-sections -I$(MUSL)/core \
               '-Dhidden=__attribute__((visibility("hidden")))' -Dfloat_t=float -Ddouble_t=double \
               $(FLAGS_$(MACHINE)) $(MUSL_$(MACHINE))
$(MUSL)/core/whole: tools/source | deps
	$(Q)tools/source musl $(MUSL) && touch $@
$(O)/musl/flags: FLAGS := $(CC) $(MUSL_CFLAGS)
$(addprefix $(O)/musl/,$(addsuffix .o,$(ELEMENTARY) $(ELEMENTARY_PARTS))): $(O)/musl/%.o: $(MUSL)/core/whole $(O)/musl/flags
	@mkdir -p $(@D)
	$(Q)$(CC) $(MUSL_CFLAGS) -c -o $@ $(MUSL)/core/$*.c
ARITHMETIC := $(O)/musl/arithmetic.o
$(ARITHMETIC): $(addprefix $(O)/musl/,$(addsuffix .o,$(ELEMENTARY) $(ELEMENTARY_PARTS)))
	@echo "  LINK  $@"
	$(Q)$(CC) -r -nostdlib -o $@ $^

# ODE by its own configure script, of which the engine's headers are the distribution's.
CCD := $(EXACT:%=%/libccd.a)
ODE := $(EXACT:%=%/libode.a)
EXACT_CFLAGS := -O2 -g -w -ffp-contract=off $(NO_BUILTIN) -fPIC -ffunction-sections -fdata-sections
build/ode/core/whole build/libccd/core/whole: build/%/core/whole: tools/source | deps
	$(Q)tools/source $* build/$* && touch $@
build/exact/%/libccd.a: build/libccd/core/whole | deps
	@mkdir -p $(@D)/ccd; echo "  CC    build/libccd/core/*.c"
	$(Q)cd $(@D)/ccd && $(CC) $(EXACT_CFLAGS) -DCCD_DOUBLE -I$(CURDIR)/$(<D) -c $(CURDIR)/$(<D)/*.c
	$(Q)rm -f $@ && $(TOOL)ar rcs $@ $(@D)/ccd/*.o
build/exact/%/libode.a: build/ode/core/whole | deps
	@mkdir -p $(@D)/ode; echo "  CXX   build/ode/core/ode/src/*.cpp"
	$(Q)cd $(@D)/ode && { $(CURDIR)/$(<D)/configure $(CROSS:%=--host=%) --enable-double-precision --with-trimesh=none \
	  --disable-demos CC='$(CC)' CXX='$(CXX)' CFLAGS='$(EXACT_CFLAGS)' CXXFLAGS='$(EXACT_CFLAGS)' && \
	  MAKEFLAGS= $(MAKE) -j$(shell nproc); } >log 2>&1 || { tail -n 20 log; false; }
	$(Q)cp $(@D)/ode/ode/src/.libs/libode.a $@

# Both libraries have the same in them: what is exported, and what that needs.
$(O)/libmuster.a: $(O)/libmuster.so.0 $$(call module_objs,runtime)
	@mkdir -p $(@D); echo "  AR    $@"
	$(Q)$(CC) -r -nostdlib -Wl,--gc-sections -o $(O)/libmuster.o $(filter %.o,$^) \
	  $$($(TOOL)nm -D --defined-only $< | sed -n 's/.* [TDRB] \([^@]*\).*/-Wl,-u,\1/p')
	$(Q)$(TOOL)objcopy --localize-hidden $(O)/libmuster.o # a program may have a bus_open of its own
	$(Q)rm -f $@ && $(TOOL)ar rcs $@ $(O)/libmuster.o

comma  := ,
PACKED := $(if $(filter x86_64,$(MACHINE)),-Wl$(comma)-z$(comma)pack-relative-relocs)
$(O)/libmuster.so.0: src/runtime/libmuster.map $$(call module_objs,runtime)
	@mkdir -p $(@D); echo "  LINK  $@"
	$(Q)$(CC) -shared $(LDFLAGS) -Wl,-soname,libmuster.so.0 -Wl,--version-script=$< \
	  $(PACKED) $(if $(filter asan,$(BUILD)),,-Wl,-z,defs) -o $@ $(filter %.o,$^) $(LIBS_runtime)

# Loaded before the C library by the children of a run that has faults of the network.
$(FAULTS): $(call objs,faults) $(O)/src/core/clock.o
	@mkdir -p $(@D); echo "  LINK  $@"
	$(Q)$(CC) -shared $(LDFLAGS) -o $@ $^
$(O)/unit/bus: | $(FAULTS)

# Loaded by processes that a test spoils.
$(O)/preload/%.so: $(O)/tests/preload/%.o
	@mkdir -p $(@D); echo "  LINK  $@"
	$(Q)$(CC) -shared $(LDFLAGS) -o $@ $^

$(O)/examples/%: $(O)/examples/%.o $(O)/libmuster.a
	@mkdir -p $(@D); echo "  LINK  $@"
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ -lddsc -lm

# They look at topics, too, which the library keeps to itself.
$(O)/programs/%: $(O)/tests/programs/%.o $$(call module_objs,runtime)
	@mkdir -p $(@D); echo "  LINK  $@"
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ -lddsc -lm

# A stranger's types are not among ours.
$(O)/programs/stranger: $(O)/gen/stranger.o
$(O)/tests/programs/stranger.o: | $(O)/gen/stranger.h
$(O)/gen/stranger.c $(O)/gen/stranger.h &: tests/programs/stranger.idl | deps
	@mkdir -p $(@D); echo "  IDLC  $<"
	$(Q)idlc -l c -o $(@D) $<

# It counts what the static library allocates.
$(O)/programs/memory_counter: LDFLAGS += -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc

# One program for the unit tests of a module: MODULE TOPIC runs tests/unit/MODULE/TOPIC.c.
topics   = $(patsubst tests/unit/$(1)/%.c,%,$(wildcard tests/unit/$(1)/*.c))
SUPPORT := $(patsubst %.c,$(O)/%.o,$(wildcard tests/support/unit/*.c))
SUPPORT_broker := $(patsubst %.c,$(O)/%.o,$(wildcard tests/support/unit/history/*.c))
$(UNITS): $(O)/unit/%: $(SUPPORT) $(O)/unit/%.table.o $$(addsuffix .o,$$(addprefix $(O)/,$$(basename $$(wildcard tests/unit/$$*/*.c)))) \
  $$(SUPPORT_$$*) $$(call module_objs,$$*)
	@echo "  LINK  $@"
	$(Q)$(CC) $(LDFLAGS) -o $@ $(filter %.o %.a,$^) -lcunit $(LIBS_$*)

$(O)/unit/%.table.c: tests/unit/%
	@mkdir -p $(@D)
	@{ printf '#include "units.h"\n'; printf 'int unit_%s(void);\n' $(call topics,$*); \
	  echo 'const struct unit units[] = {'; printf '    {"%s", unit_%s},\n' $(foreach t,$(call topics,$*),$t $t); \
	  echo '    {0}};'; } > $@
$(O)/unit/%.table.o: $(O)/unit/%.table.c $(O)/flags
	$(Q)$(CC) -Itests/support/unit $(CFLAGS) -c -o $@ $<
$(O)/tests/unit/%.o: override CPPFLAGS += -Itests/support/unit -Dmain=unit_$(*F)
$(O)/tests/unit/%.o: CFLAGS += -Wno-missing-prototypes
$(SUPPORT) $(patsubst %.c,$(O)/%.o,$(wildcard tests/unit/*/*.c)): | test-deps

bench_module = $(word 1,$(subst _, ,$(1)))
$(O)/bench/micro/%: $(O)/bench/micro/%.o $$(call module_objs,$$(call bench_module,$$*))
	@mkdir -p $(@D); echo "  LINK  $@"
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(LIBS_$(call bench_module,$*))

# gcc names no header of -isystem, and a patch of CLIPS may change a struct.
$(O)/%.o: %.c $(O)/flags $(CLIPS)/core/whole | $(GEN:.o=.h) deps
	@mkdir -p $(@D); echo "  CC    $<"
	$(Q)$(CC) $(CPPFLAGS) $(CFLAGS) -c -o $@ $<

# Known when the packages are there.
$(O)/src/run/run_start.o $(O)/src/run/run_report.o: override CPPFLAGS += -DMU_CLIPS_VERSION='"$(shell \
  sed -n 's/^.define VERSION_STRING "\(.*\)"/\1/p' $(CLIPS)/core/constant.h)"'

# In the library, and not where time is spent: small, not fast.
COLD := $(patsubst %,$(O)/src/%.o,stats/approach stats/explored stats/goal stats/stats \
  runtime/watch runtime/watch_states runtime/watch_sample runtime/resolver runtime/directory_changes runtime/transfers \
  runtime/probes runtime/probes_look runtime/kind_base runtime/life runtime/link runtime/choice \
  bus/wire/beacons bus/bus_open bus/config bus/topics bus/local_shared bus/local_token bus/bus_matches \
  runtime/process runtime/process_states runtime/agent_life runtime/roll)
ifeq ($(BUILD)$(LEVEL),release-O2)
$(COLD): CFLAGS += -Os
endif

# What casts rays is worth more of the compiler's time.  No result may depend on the trap flags.
RAYS := $(patsubst %,$(O)/src/sim/%.o,geometry/grid sensors/fan_portable sensors/fan_sse2 sensors/fan_avx2 sensors/fan_avx512)
ifeq ($(BUILD)$(LEVEL),release-O2)
$(RAYS): CFLAGS += -O3 -fno-trapping-math
endif
# The same source for each vector unit of the processor; which one runs is found out at the start.
ifneq ($(filter x86_64%,$(shell $(CC) -dumpmachine)),)
$(O)/src/sim/sensors/fan_avx2.o: CFLAGS += -mavx2
$(O)/src/sim/sensors/fan_avx512.o: CFLAGS += -mavx512f -mavx512dq -mprefer-vector-width=512
endif

$(ASSETS): $(O)/%.o: %
	@mkdir -p $(@D); echo "  EMBED $<"
	$(Q)$(TOOL)ld -r -b binary -z noexecstack -o $@ $<

$(O)/gen/%.c $(O)/gen/%.h &: idl/%.idl | deps
	@mkdir -p $(@D); echo "  IDLC  $<"
	$(Q)idlc -l c -o $(@D) $<
$(O)/gen/%.o: $(O)/gen/%.c $(O)/flags
	$(Q)$(CC) -I$(O)/gen $(FLAGS_$(BUILD)) $(SHARED) -w -c -o $@ $<

# --- use -----------------------------------------------------------------------------------------
EXPERIMENT ?= experiments/follow.yaml
ARGS       ?=
.PHONY: run
run: all ## run an experiment headless and leave a report: EXPERIMENT=, ARGS="--seed 2 ..."
	@$(O)/bin/muster run $(EXPERIMENT) $(ARGS)

.PHONY: emulated
emulated: all ## with CROSS=TRIPLET: programs of another architecture that run here, in qemu's user mode
	@tools/emulate $(O) $(O)/emulated $(EMULATOR)

# --- tests ---------------------------------------------------------------------------------------
.PHONY: helpers programs-test test check quick unit rules system tidy asan hashes coverage test-cross
helpers: $(HELPERS) $(PRELOADS) $(O)/test/gohome $(O)/test/way
programs-test: test-deps all helpers $(UNITS) $(O)/test/rules $(O)/test/clips

test: programs-test ## every test: tidy, unit, rules, system, and again under the sanitizers (12 minutes)
	@$(MAKE) --no-print-directory BUILD=asan programs-test
	@BUILD=$(BUILD) tests/run all

check: programs-test ## tidy, all unit and rule tests, and the system tests that are fast (3 minutes)
	@BUILD=$(BUILD) tests/run check

unit: $(UNITS) ## the unit tests of every module
	@BUILD=$(BUILD) tests/run units

rules: test-deps $(O)/test/rules $(O)/test/clips ## the rule tests: tests/rules/muster/*.clp against their `; expect:` lines, tests/rules/engine against the program clips
	@BUILD=$(BUILD) tests/run rules engine

system: test-deps all helpers ## the system tests: real processes on loopback
	@BUILD=$(BUILD) tests/run system

test-cross: all ## one hash on arm64, armhf, ppc64el and s390x, in qemu's user mode: no part of `make test`; an hour
	@tests/cross

hashes: all ## every experiment, seeds 1 to 5, against tests/hashes.txt
	@BUILD=$(BUILD) tests/hashes

# A stamp for each check, so that make finds what a change touches.
quick: test-deps all helpers $(UNITS:%=%.ok) $(O)/tidy.ok $(O)/rules.ok $(O)/system.ok $(O)/pages.ok $(O)/follow.ok ## what a change touches: its units, tidy, one whole run (10 seconds)

$(UNITS:%=%.ok) $(addprefix $(O)/,tidy.ok rules.ok system.ok pages.ok follow.ok): | test-deps
PYTEST := BUILD=$(BUILD) pytest-3 -n $(shell expr 3 \* `nproc`) --dist loadgroup
$(UNITS:%=%.ok): %.ok: %
	@BUILD=$(BUILD) tests/units --fast $(*F) > $@.log || { cat $@.log; false; }
	@grep '^  $(*F)' $@.log; touch $@
$(O)/tidy.ok: $(SOURCES) $(OBJECTS) $(PROGRAMS) $(wildcard tools/*.py)
	@BUILD=$(BUILD) tools/tidy.py && touch $@
$(O)/rules.ok: $(O)/test/rules $(wildcard rules/*.clp tests/rules/muster/*.clp tests/rules/muster/*/*.clp)
	@$< $(wildcard tests/rules/muster/*.clp) && touch $@
$(O)/system.ok: $(wildcard tests/system/*.py tests/support/system/*.py) | all helpers
	@$(PYTEST) -m quick $(or $(filter tests/system/test_%,$?),tests/system/test_usage.py) && touch $@
$(O)/pages.ok: $(shell find . -name '*.md' -not -path './build/*') | all
	@$(PYTEST) -m quick tests/system/test_docs.py && touch $@
$(O)/follow.ok: $(PROGRAMS) $(wildcard rules/*.clp) experiments/follow.yaml worlds/arena.world
	@BUILD=$(BUILD) tests/hashes follow:1 && touch $@

.PHONY: soak
soak: all ## twenty whole runs, idle, busy and paced: one hash
	@BUILD=$(BUILD) tests/soak/determinism.py

.PHONY: bare
bare: ## `make run` and `make test` in a bare Debian 12, as root and as a user with sudo: as root, with debootstrap
	@tests/soak/bare

.PHONY: soak-builds
soak-builds: ## one hash of the simulator: gcc and clang, -O0 to -O3, every kernel of beams
	@tests/soak/builds.py

.PHONY: soak-model
soak-model: $(O)/unit/broker ## a minute of random histories of the broker, from other seeds each time
	@MUSTER_SECONDS=40 $(O)/unit/broker history
	@MUSTER_SECONDS=20 $(O)/unit/broker links

.PHONY: soak-store
soak-store: all $(HELPERS) ## a hundred kills of the broker: no durable mail or change lost
	@BUILD=$(BUILD) tests/soak/store.py

.PHONY: soak-churn
soak-churn: all $(HELPERS) ## a minute and a half of processes that are killed, stopped and started under mail
	@BUILD=$(BUILD) tests/soak/churn.py

.PHONY: soak-names
soak-names: all $(HELPERS) ## half an hour of names that come and go, 100 a second, and a full broker; COUNT=20000 RATE=200 EXPIRY=20: less
	@BUILD=$(BUILD) tests/soak/names.py $(COUNT) $(RATE) $(EXPIRY)

.PHONY: soak-crash
soak-crash: all $(PRELOADS) ## a hundred kills of controllers, resolvers and brokers of runs that go on
	@BUILD=$(BUILD) tests/soak/crash.py

.PHONY: soak-standstill
soak-standstill: all ## a hundred runs in which robots are killed and stopped at random steps: one hash
	@BUILD=$(BUILD) tests/soak/standstill.py

.PHONY: soak-brokers
soak-brokers: all $(HELPERS) ## a link between two brokers that is cut for half a minute
	@CUT_S=30 BUILD=$(BUILD) $(PYTEST) -k test_the_link_between

.PHONY: soak-moves
soak-moves: all ## a hundred moves in lock step, a hundred in free running, a hundred kills on the way; clones
	@BUILD=$(BUILD) tests/soak/moves.py

.PHONY: soak-verify
soak-verify: all $(O)/test/sensed ## twenty recordings that go the same way again, every stall of ten runs explained, and what counts as sensed in ten of every experiment
	@BUILD=$(BUILD) tests/soak/verify.py

.PHONY: soak-worlds
soak-worlds: $(O)/unit/world ## sixty thousand damaged world files, from another seed each time
	@MUSTER_SEED=$${MUSTER_SEED:-$$RANDOM} MUSTER_ROUNDS=60000 timeout 300 $< garbage

.PHONY: soak-recordings
soak-recordings: $(O)/unit/mcap ## sixty thousand damaged recordings, from another seed each time
	@MUSTER_SEED=$${MUSTER_SEED:-$$RANDOM} MUSTER_ROUNDS=60000 timeout 300 $< garbage

# The tests of what reads recordings and samples of strangers; each case is one file or sample.
STRANGERS := "mcap garbage" "story garbage" "runtime garbage" "bus foreign" "bus tap"
.PHONY: soak-strangers
soak-strangers: ## 200,000 damaged recordings and samples, and a hundred of them to whole programs, under the sanitizers
	@$(MAKE) --no-print-directory BUILD=asan all build/asan/programs/stranger \
	  $(addprefix build/asan/unit/,mcap story runtime bus web)
	@set -e; for t in $(STRANGERS); do MUSTER_SEED=$${MUSTER_SEED:-$$RANDOM} MUSTER_ROUNDS=40000 \
	  timeout 3000 build/asan/unit/$$t; done
	@MUSTER_SEED=$${MUSTER_SEED:-$$RANDOM} MUSTER_ROUNDS=4000 timeout 3000 build/asan/unit/web garbage
	@BUILD=asan tests/soak/strangers.py

.PHONY: soak-crush
soak-crush: $(O)/unit/sim ## a thousand robots that press towards one place for a minute
	@MUSTER_ROBOTS=1000 MUSTER_SECONDS=60 $(O)/unit/sim crush

.PHONY: soak-gohome
soak-gohome: $(O)/test/gohome ## (gohome) from fifty random places of each world: how many arrive
	@BUILD=$(BUILD) tests/soak/gohome

.PHONY: soak-minds
soak-minds: ## a million random lines and damaged rule files for minds, under the sanitizers
	@$(MAKE) --no-print-directory BUILD=asan build/asan/unit/mind
	@set -e; for seed in {1..20}; do MUSTER_SEED=$$seed MUSTER_ROUNDS=50000 \
	  build/asan/unit/mind fuzz; done

.PHONY: soak-engine
soak-engine: $(O)/test/clips ## 1200 random programs in the program clips and in a mind, from other seeds each time
	@set -e; for seed in {1..4}; do BUILD=$(BUILD) tests/soak/engine.py $$RANDOM; done

.PHONY: soak-snapshots
soak-snapshots: $(O)/test/snapshots ## 1200 random programs, each cut somewhere: minds go on from their snapshots, from other seeds each time
	@set -e; for seed in {1..4}; do BUILD=$(BUILD) tests/soak/snapshots.py $$RANDOM; done

tidy: test-deps $(OBJECTS) $(PROGRAMS) ## the house rules that a compiler cannot check
	@BUILD=$(BUILD) tools/tidy.py

asan: ## unit and rule tests under the address and undefined-behaviour sanitizers
	@$(MAKE) --no-print-directory BUILD=asan programs-test
	@tests/run asan-units asan-leaks asan-rules asan-engine

coverage: ## unit tests with gcov; needs gcovr
	@$(MAKE) --no-print-directory BUILD=coverage unit && gcovr -r . --object-directory build/coverage

$(O)/test/clips: $(O)/tests/rules/engine/embedded.o $$(call module_objs,mind)
	@mkdir -p $(@D); echo "  LINK  $@"
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(LIBS_mind)

$(O)/test/snapshots: $(O)/tests/soak/snapshots.o $$(call module_objs,mind)
	@mkdir -p $(@D); echo "  LINK  $@"
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(LIBS_mind)

# A mind and the engine in one process, which no program of ours has.
$(O)/test/gohome: $(O)/tests/soak/gohome.o $$(call module_objs,mind) $$(call objs,sim) $$(call objs,bus) $(GEN) $$(call objs,mcap) $(ODE)
	@mkdir -p $(@D); echo "  LINK  $@"
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(LIBS_agent) -lode -lcrypto -lz

# The broker with each entry and exit of its functions told: tests/system/test_way.py counts them.
WAY_SOURCES := $(filter-out %/main.c,$(filter src/broker/%,$(CODE)))
$(O)/way/%.o: %.c $(O)/flags | $(GEN:.o=.h) deps
	@mkdir -p $(@D); echo "  CC    $< (way)"
	$(Q)$(CC) $(CPPFLAGS) $(filter-out -O%,$(CFLAGS)) -O0 -finstrument-functions \
	  -finstrument-functions-exclude-file-list=.h -c -o $@ $<
$(O)/tests/way/way.o: override CPPFLAGS += -Itests/support/unit
$(O)/test/way: $(O)/tests/way/way.o $(O)/tests/support/unit/suite.o $(WAY_SOURCES:%.c=$(O)/way/%.o) $$(call objs,bus) $$(call objs,core) $(GEN)
	@mkdir -p $(@D); echo "  LINK  $@"
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ -lcunit $(LIBS_broker)

$(O)/test/sensed: $(O)/tests/soak/sensed.o $$(call module_objs,story)
	@mkdir -p $(@D); echo "  LINK  $@"
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(LIBS_story)

$(O)/test/rules: $(O)/tests/rules/muster/rules.o $$(call module_objs,mind)
	@mkdir -p $(@D); echo "  LINK  $@"
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(LIBS_mind)

.PHONY: bench
bench: all $(BENCHES) ## mail, lock step and controller cycles, as ratios to a direct DDS write
	@O=$(O) BUILD=$(BUILD) bench/micro/run

.PHONY: bench-recording
bench-recording: all ## what run.mcap costs a run, in interleaved rounds: ARGS=ROUNDS
	@BUILD=$(BUILD) bench/run/recording $(ARGS)

.PHONY: bench-scale
bench-scale: all ## many robots in whole runs, one process against two: ARGS="--robots 100 1000 --rounds 3"
	@BUILD=$(BUILD) bench/sim/scale $(ARGS)

.PHONY: bench-agents
bench-agents: all ## agents without a body and without a simulator, each with a timer and mail: ARGS="--agents 1000 --rounds 3"
	@BUILD=$(BUILD) bench/run/agents $(ARGS)

.PHONY: bench-web
bench-web: all $(O)/programs/frame_feeder ## the live page: frames for viewers and in a browser, processor time of the server
	@BUILD=$(BUILD) bench/web/page $(ARGS)

.PHONY: bench-slider
bench-slider: all ## the time slider: how long the page waits for a moment of a ten minute recording
	@BUILD=$(BUILD) bench/web/slider $(ARGS)

.PHONY: bench-minds
bench-minds: $(O)/test/clips $(O)/bench/micro/mind_cycle ## a robot's control cycle; the engine in a robot against the program clips
	@BUILD=$(BUILD) bench/minds/run $(ARGS)

# Against other brokers: their packages are asked for here, and needed nowhere else.
PEERS := $(addprefix $(O)/bench/broker/peer_,muster dds mqtt nats redis)
LIBS_peer_muster := -lddsc -lm
LIBS_peer_dds    := -lddsc -lm
LIBS_peer_mqtt   := -lmosquitto
LIBS_peer_nats   := -lnats
LIBS_peer_redis  := -lhiredis
OBJS_peer_muster := $(call module_objs,runtime)
OBJS_peer_dds    := $(call module_objs,bus)
$(PEERS): $(O)/bench/broker/peer_%: $(O)/bench/broker/peer_%.o $$(OBJS_peer_$$*) \
  $(patsubst %,$(O)/bench/broker/%.o,load load_cpu load_steady load_crowd load_box) $(call objs,core)
	@mkdir -p $(@D); echo "  LINK  $@"
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(LIBS_peer_$*)

$(PEERS:%=%.o): | bench-broker-packages

.PHONY: bench-broker bench-broker-packages
bench-broker-packages:
	@bench/broker/packages
bench-broker: bench-broker-packages all $(BENCHES) $(PEERS) ## ours against mosquitto, NATS and Redis: ARGS="--rounds 5 --only NAME --markdown"
	@O=$(O) BUILD=$(BUILD) bench/broker/run $(ARGS)

# Against other simulators: Box2D is asked for here, and needed nowhere else.
RACERS := $(addprefix $(O)/bench/sim/,engine rays box2d)
$(O)/bench/sim/engine $(O)/bench/sim/rays: $(O)/bench/sim/%: $(O)/bench/sim/%.o $(call module_objs,sim)
	@mkdir -p $(@D); echo "  LINK  $@"
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(LIBS_sim)
$(O)/bench/sim/box2d: bench/sim/box2d.cc bench/sim/wander.h | bench-sim-packages
	@mkdir -p $(@D); echo "  CXX   $@"
	$(Q)$(CXX) -std=c++17 -O3 -Wall -Wextra -o $@ $< -lbox2d

.PHONY: bench-sim bench-sim-packages
bench-sim-packages:
	@bench/sim/packages
bench-sim: bench-sim-packages all $(RACERS) ## our engine against Box2D and a prototype, then whole runs: ARGS="--rounds 5 --robots 100,1000"
	@O=$(O) BUILD=$(BUILD) bench/sim/run $(ARGS)
	@BUILD=$(BUILD) bench/sim/scale

# --- hygiene -------------------------------------------------------------------------------------
.PHONY: fmt fmt-check docs install uninstall clean help
fmt: ## format every source file in place (clang-format)
	@clang-format -i $(SOURCES)
fmt-check: ## fail if a file is not formatted
	@clang-format --dry-run --Werror $(SOURCES)

.PHONY: interface
interface: all ## write down the interface of this version: what libmuster.so.0 exports, the types of the wire
	@tools/interface --write

docs: all ## print the reference pages from the tables in the code
	@tools/make-reference $(O)/bin

.PHONY: FORCE
$(O)/muster.pc: FORCE
	@mkdir -p $(@D)
	@printf '%s\n' 'prefix=$(PREFIX)' 'Name: muster' \
	  'Description: Runtime for teams of robots and other agents on DDS' 'Version: $(VERSION)' \
	  'libdir=$${prefix}/lib' 'Cflags: -I$${prefix}/include' 'Libs: -L$${libdir} -lmuster' \
	  'Libs.private: -lddsc -lm' > $@.$$$$ && mv $@.$$$$ $@ # somebody else may install, too

# What shells source to complete command lines, printed by the program from its tables.
COMPLETIONS := $(O)/completion/muster $(O)/completion/_muster $(O)/completion/muster.fish
$(O)/completion/muster:      SHELL_NAME := bash
$(O)/completion/_muster:     SHELL_NAME := zsh
$(O)/completion/muster.fish: SHELL_NAME := fish
COMPLETED := share/bash-completion/completions/muster share/zsh/site-functions/_muster share/fish/vendor_completions.d/muster.fish
$(COMPLETIONS): $(PROGRAMS)
	@mkdir -p $(@D)
	$(Q)$(EMULATOR) $(O)/bin/muster completion $(SHELL_NAME) > $@.$$$$ && mv $@.$$$$ $@

install: all $(O)/muster.pc $(COMPLETIONS) ## install programs, library, headers, rules, worlds: PREFIX=, DESTDIR=
	install -d $(addprefix $(DESTDIR)$(PREFIX)/,bin lib/pkgconfig lib/muster include/muster share/muster/rules \
	  share/muster/worlds share/muster/experiments share/doc/muster share/man/man1 \
	  $(dir $(COMPLETED)))
	install -m755 $(PROGRAMS) $(DESTDIR)$(PREFIX)/bin
	install -m644 $(O)/libmuster.a $(O)/libmuster.so.0 $(DESTDIR)$(PREFIX)/lib
	ln -sf libmuster.so.0 $(DESTDIR)$(PREFIX)/lib/libmuster.so
	install -m644 $(FAULTS) $(DESTDIR)$(PREFIX)/lib/muster
	install -m644 $(O)/muster.pc $(DESTDIR)$(PREFIX)/lib/pkgconfig
	install -m644 include/muster/*.h $(DESTDIR)$(PREFIX)/include/muster
	install -m644 rules/* $(DESTDIR)$(PREFIX)/share/muster/rules
	install -m644 worlds/* $(DESTDIR)$(PREFIX)/share/muster/worlds
	install -m644 experiments/* $(DESTDIR)$(PREFIX)/share/muster/experiments
	install -m644 LICENSE NOTICE $(DESTDIR)$(PREFIX)/share/doc/muster
	install -m644 docs/man/*.1 $(DESTDIR)$(PREFIX)/share/man/man1
	$(foreach c,$(COMPLETED),install -m644 $(O)/completion/$(notdir $(c)) $(DESTDIR)$(PREFIX)/$(c) && ) true

uninstall: ## remove what install put there
	rm -f $(addprefix $(DESTDIR)$(PREFIX)/bin/,$(notdir $(PROGRAMS))) \
	  $(addprefix $(DESTDIR)$(PREFIX)/lib/libmuster.,a so so.0) \
	  $(DESTDIR)$(PREFIX)/lib/pkgconfig/muster.pc $(DESTDIR)$(PREFIX)/share/man/man1/muster*.1 \
	  $(addprefix $(DESTDIR)$(PREFIX)/,$(COMPLETED))
	rm -rf $(addprefix $(DESTDIR)$(PREFIX)/,include/muster lib/muster share/muster share/doc/muster)

clean: ## remove build/
	rm -rf build

help: ## this text
	@awk -F':.*## ' '/^[a-z][a-z -]*:.*## /{printf "  %-12s %s\n", $$1, $$2}' $(MAKEFILE_LIST)
	@echo; echo "  BUILD=release|asan|coverage  CROSS=aarch64-linux-gnu  DEPS=skip  PREFIX=$(PREFIX)  V=1 shows the commands"

-include $(shell find $(O) -name '*.d' 2>/dev/null)
