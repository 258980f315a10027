/* A team of MASCOT as an FMU for co-simulation, of FMI 2.0 and FMI 3.0 (docs/fmu.md). This file is the same for all
 * teams: what differs is in the FMU's folder `resources`: variables.txt, which orchestrator/fmu/variable_table.cc
 * writes, and experiment.toml. The team itself flies in a process of its own, `orchestrator serve`, which this file
 * starts (on Linux), or joins at an address; the bytes between are those of docs/serve.md.
 *
 * C99, and nothing but the C library and sockets. For a static library, define FMI2_FUNCTION_PREFIX or
 * FMI3_FUNCTION_PREFIX as the prefix of all functions, such as `leaderless_`.
 */
#if defined(__linux__)
#define _GNU_SOURCE /* pipe2, SOCK_CLOEXEC */
#elif !defined(_WIN32)
#define _POSIX_C_SOURCE 200809L
#define _DARWIN_C_SOURCE /* SO_NOSIGPIPE */
#endif

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(_WIN32)
#include <winsock2.h>
#include <ws2tcpip.h>
/* below winsock2.h, which must come first */
#include <windows.h>
#if defined(_MSC_VER)
#pragma comment(lib, "ws2_32")
#endif
typedef SOCKET Socket;
#define NO_SOCKET INVALID_SOCKET
#else
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <time.h>
#include <unistd.h>
typedef int Socket;
#define NO_SOCKET (-1)
#if defined(__linux__)
#include <spawn.h>
#include <sys/wait.h>
#define STARTS_SERVERS 1
extern char** environ;
#endif
#endif

#if defined(__GNUC__)
#define LIKE_PRINTF(place, first) __attribute__((format(printf, place, first)))
#else
#define LIKE_PRINTF(place, first)
#endif

/* ------------------------------------------------------------------------------------------------------------------
 * What FMI prescribes: types, and names of functions.
 */

enum { OK, WARNING, DISCARD, ERRED, FATAL };

typedef void (*Logger2)(void* environment, const char* name, int status, const char* category, const char* message,
                        ...);
typedef void (*Logger3)(void* environment, int status, const char* category, const char* message);

typedef struct {
  Logger2 logger;
  void* (*allocate)(size_t count, size_t size);
  void (*release)(void* memory);
  void (*step_finished)(void* environment, int status);
  void* environment;
} Callbacks2;

typedef struct {
  int new_discrete_states_needed, terminate, nominals_changed, values_changed, next_event_time_defined;
  double next_event_time;
} EventInfo2;

#define PASTED(a, b) a##b
#define JOINED(a, b) PASTED(a, b)
#if defined(FMI2_OVERRIDE_FUNCTION_PREFIX) && defined(FMI2_ACTUAL_FUNCTION_PREFIX)
#define FMI2(name) JOINED(FMI2_ACTUAL_FUNCTION_PREFIX, fmi2##name)
#elif !defined(FMI2_OVERRIDE_FUNCTION_PREFIX) && defined(FMI2_FUNCTION_PREFIX)
#define FMI2(name) JOINED(FMI2_FUNCTION_PREFIX, fmi2##name)
#else
#define FMI2(name) fmi2##name
#endif
#if defined(FMI3_OVERRIDE_FUNCTION_PREFIX) && defined(FMI3_ACTUAL_FUNCTION_PREFIX)
#define FMI3(name) JOINED(FMI3_ACTUAL_FUNCTION_PREFIX, fmi3##name)
#elif !defined(FMI3_OVERRIDE_FUNCTION_PREFIX) && defined(FMI3_FUNCTION_PREFIX)
#define FMI3(name) JOINED(FMI3_FUNCTION_PREFIX, fmi3##name)
#else
#define FMI3(name) fmi3##name
#endif
#if defined(_WIN32)
#define EXPORTED __declspec(dllexport)
#elif defined(__GNUC__)
#define EXPORTED __attribute__((visibility("default")))
#else
#define EXPORTED
#endif

/* ------------------------------------------------------------------------------------------------------------------
 * Text that grows, numbers as text, JSON.
 */

typedef struct {
  char* at; /* ends with a zero, once something was added */
  size_t size, room;
  bool failed; /* there was no memory */
} Text;

static void AddBytes(Text* text, const void* bytes, size_t size) {
  if (text->failed) return;
  if (text->size + size + 1 > text->room) {
    size_t room = 2 * text->room + size + 64;
    char* larger = realloc(text->at, room);
    if (larger == NULL) {
      text->failed = true;
      return;
    }
    text->at = larger;
    text->room = room;
  }
  if (size > 0) memcpy(text->at + text->size, bytes, size);
  text->size += size;
  text->at[text->size] = '\0';
}

static void AddWords(Text* text, const char* words) { AddBytes(text, words, strlen(words)); }

static void Clear(Text* text) {
  free(text->at);
  memset(text, 0, sizeof *text);
}

static void DropFront(Text* text, size_t size) {
  memmove(text->at, text->at + size, text->size - size + 1);
  text->size -= size;
}

/* A number as JSON that reads back as the same double. The decimal point of the tool's locale becomes a point. */
static void AddNumber(Text* text, double number) {
  char digits[64];
  bool has_point = false;
  snprintf(digits, sizeof digits, "%.17g", number);
  for (const char* digit = digits; *digit != '\0'; ++digit) {
    if (strchr("+-0123456789e", *digit) != NULL)
      AddBytes(text, digit, 1);
    else if (!has_point)
      AddBytes(text, ".", 1);
    has_point = has_point || strchr("+-0123456789e", *digit) == NULL;
  }
}

static void AddInteger(Text* text, int64_t number) {
  char digits[32];
  snprintf(digits, sizeof digits, "%lld", (long long)number);
  AddWords(text, digits);
}

static void AddJsonText(Text* text, const char* words) {
  AddWords(text, "\"");
  for (; *words != '\0'; ++words) {
    char escaped[8];
    if ((unsigned char)*words < 0x20 || *words == '"' || *words == '\\') {
      snprintf(escaped, sizeof escaped, "\\u%04x", (unsigned)(unsigned char)*words);
      AddWords(text, escaped);
    } else {
      AddBytes(text, words, 1);
    }
  }
  AddWords(text, "\"");
}

/* The end of the JSON value that begins at `at`. The servers's answers are well-formed; other text ends at `end`. */
static const char* JsonEnd(const char* at, const char* end) {
  int depth = 0;
  bool is_text = false;
  for (; at < end; ++at) {
    if (is_text) {
      if (*at == '\\')
        ++at;
      else if (*at == '"')
        is_text = false;
    } else if (*at == '"') {
      is_text = true;
    } else if (*at == '{' || *at == '[') {
      ++depth;
    } else if (*at == '}' || *at == ']' || *at == ',') {
      if (depth == 0) return at;
      if (*at != ',') --depth;
    }
  }
  return end;
}

typedef struct {
  const char* at; /* null: there is none */
  size_t size;
} Piece;

/* The value of a field of a JSON object, as it is written. */
static Piece JsonField(const Text* object, const char* name) {
  Piece none = {NULL, 0}, value;
  const char *end = object->at + object->size, *at;
  if (object->size < 2 || object->at[0] != '{') return none;
  for (at = object->at + 1; at < end && *at == '"'; at = value.at + value.size + 1) {
    const char* field = ++at;
    while (at < end && *at != '"') at += *at == '\\' ? 2 : 1;
    if (at + 1 >= end) return none;
    value.at = at + 2; /* behind ": of compact JSON */
    value.size = (size_t)(JsonEnd(value.at, end) - value.at);
    if ((size_t)(at - field) == strlen(name) && memcmp(field, name, strlen(name)) == 0) return value;
  }
  return none;
}

static bool IsPiece(Piece piece, const char* text) {
  return piece.at != NULL && piece.size == strlen(text) && memcmp(piece.at, text, piece.size) == 0;
}

static unsigned HexNumber(const char* at, const char* end) {
  unsigned number = 0;
  int digit;
  for (digit = 0; digit < 4 && at + digit < end; ++digit) {
    const char* place = strchr("0123456789abcdef", at[digit] | 0x20);
    number = 16 * number + (place == NULL || at[digit] == '\0' ? 0u : (unsigned)(place - "0123456789abcdef") % 16u);
  }
  return number;
}

/* Adds the text that a JSON text stands for, as UTF-8. */
static void AddFromJson(Text* text, Piece json) {
  const char *at = json.at, *end = json.at + json.size;
  if (json.at == NULL || json.size < 2 || *at != '"') return;
  for (++at, --end; at < end; ++at) {
    static const char names[] = "bfnrt", meanings[] = "\b\f\n\r\t";
    const char* name;
    const bool is_escaped = *at == '\\';
    if (is_escaped) ++at;
    if (is_escaped && *at == 'u') {
      unsigned code = HexNumber(at + 1, end);
      char bytes[4];
      size_t size;
      at += 4;
      if (code >= 0xD800 && code < 0xDC00 && at + 6 < end) { /* the first half of a pair */
        code = 0x10000 + ((code - 0xD800) << 10) + (HexNumber(at + 3, end) - 0xDC00);
        at += 6;
      }
      size = code < 0x80 ? 1u : code < 0x800 ? 2u : code < 0x10000 ? 3u : 4u;
      bytes[0] = (char)(size == 1 ? code : (0xF00u >> size & 0xFFu) | code >> 6 * (size - 1));
      if (size > 1) bytes[size - 1] = (char)(0x80 | (code & 0x3F));
      if (size > 2) bytes[size - 2] = (char)(0x80 | (code >> 6 & 0x3F));
      if (size > 3) bytes[size - 3] = (char)(0x80 | (code >> 12 & 0x3F));
      AddBytes(text, bytes, size);
    } else if (is_escaped && (name = strchr(names, *at)) != NULL && *at != '\0') {
      AddBytes(text, meanings + (name - names), 1);
    } else {
      AddBytes(text, at, 1);
    }
  }
}

/* ------------------------------------------------------------------------------------------------------------------
 * The team's variables: resources/variables.txt.
 */

/* The letter of a variable's type in the table. */
enum { TYPE_REAL = 'r', TYPE_INTEGER = 'i', TYPE_BOOLEAN = 'b', TYPE_STRING = 's' };

typedef enum {
  ROLE_TIME,
  ROLE_ADDRESS,
  ROLE_ORCHESTRATOR,
  ROLE_ENGINE,
  ROLE_TIMEOUT,
  ROLE_SEED,
  ROLE_KEY,    /* `index`: of the key, an element of which this is */
  ROLE_ACTION, /* `index`: of the number among those of all ports */
  ROLE_TICK,
  ROLE_END,
  ROLE_FIGURE, /* `index`: of the figure */
  ROLE_STATE,  /* `agent` and `index`: which of its 13 numbers */
  ROLE_LOST,   /* `agent` */
  ROLE_COUNT,  /* `agent`: from how many it has heard */
  ROLE_HEARD,  /* `agent` and `index`: from whom */
  ROLES
} Role;

static const char* const kRoles[ROLES] = {"time",   "address", "orchestrator", "engine", "timeout",
                                          "seed",   "key",     "action",       "tick",   "end",
                                          "figure", "state",   "lost",         "count",  "heard"};

static const char* const kTypeNames2[] = {"Real", "Integer", "Boolean", "String"};
static const char* const kTypeNames3[] = {"Float64", "Int64", "Boolean", "String"};

/* A value: of a real variable `real`, of an integer `whole`, of a boolean `whole` (0 or 1), of a string `text`. */
typedef struct {
  double real;
  int64_t whole;
  char* text;
} Value;

typedef struct {
  char* name;
  int type;
  Role role;
  int agent, index;
  Value start;
} Variable;

typedef struct {
  char* path;     /* "law.p_gain" */
  char* template; /* its value as JSON, with % for each of its variables */
  size_t first;   /* of its variables */
} LiveKey;

typedef struct {
  char *token, *program, *ports;
  char* expected[8]; /* pairs: a field of hello's answer, and what it must be */
  size_t expectations;
  double rate_hz;
  size_t agents, figures, actions;
  Variable* variables;
  size_t count;
  LiveKey* keys;
  size_t key_count;
} Table;

static char* Copy(const char* text) {
  size_t size = strlen(text) + 1;
  char* copy = malloc(size);
  if (copy != NULL) memcpy(copy, text, size);
  return copy;
}

static void FreeTable(Table* table) {
  size_t k;
  for (k = 0; k < table->count; ++k) {
    free(table->variables[k].name);
    free(table->variables[k].start.text);
  }
  for (k = 0; k < table->key_count; ++k) {
    free(table->keys[k].path);
    free(table->keys[k].template);
  }
  for (k = 0; k < 2 * table->expectations; ++k) free(table->expected[k]);
  free(table->token);
  free(table->program);
  free(table->ports);
  free(table->variables);
  free(table->keys);
  memset(table, 0, sizeof *table);
}

/* The word that `*rest` begins with, which ends there; `*rest` moves behind it. */
static char* NextWord(char** rest) {
  char *word = *rest, *space = strchr(word, ' ');
  *rest = space == NULL ? word + strlen(word) : space + 1;
  if (space != NULL) *space = '\0';
  return word;
}

/* A double by the 16 hexadecimal digits of its bits, so that no locale has a say. */
static double FromBits(const char* digits) {
  uint64_t bits = strtoull(digits, NULL, 16);
  double number;
  memcpy(&number, &bits, sizeof number);
  return number;
}

/* Room for one more item of an array. Returns false if there is no memory. */
static bool Grow(void** array, size_t count, size_t item) {
  void* larger;
  if ((count & (count - 1)) != 0) return true;
  larger = realloc(*array, (count == 0 ? 1 : 2 * count) * item);
  if (larger == NULL) return false;
  *array = larger;
  return true;
}

/* variable NAME TYPE ROLE AGENT INDEX START */
static bool ReadVariable(Table* table, char* rest) {
  Variable variable;
  const char* role;
  if (!Grow((void**)&table->variables, table->count, sizeof variable)) return false;
  memset(&variable, 0, sizeof variable);
  variable.name = Copy(NextWord(&rest));
  variable.type = (unsigned char)*NextWord(&rest);
  role = NextWord(&rest);
  for (variable.role = ROLE_TIME; variable.role < ROLES && strcmp(kRoles[variable.role], role) != 0;) ++variable.role;
  variable.agent = atoi(NextWord(&rest));
  variable.index = atoi(NextWord(&rest));
  if (variable.type == TYPE_REAL) variable.start.real = FromBits(rest);
  if (variable.type == TYPE_INTEGER || variable.type == TYPE_BOOLEAN) variable.start.whole = strtoll(rest, NULL, 10);
  if (variable.type == TYPE_STRING) variable.start.text = Copy(rest);
  table->variables[table->count++] = variable;
  return variable.name != NULL && variable.role < ROLES &&
         (variable.type != TYPE_STRING || variable.start.text != NULL);
}

/* key PATH TEMPLATE: its variables come next */
static bool ReadKey(Table* table, char* rest) {
  LiveKey key;
  if (!Grow((void**)&table->keys, table->key_count, sizeof key)) return false;
  key.path = Copy(NextWord(&rest));
  key.template = Copy(rest);
  key.first = table->count;
  table->keys[table->key_count++] = key;
  return key.path != NULL && key.template != NULL;
}

static bool ReadLine(Table* table, char* line) {
  char *rest = line, *word = NextWord(&rest);
  if (strcmp(word, "variable") == 0) return ReadVariable(table, rest);
  if (strcmp(word, "key") == 0) return ReadKey(table, rest);
  if (strcmp(word, "token") == 0) return (table->token = Copy(rest)) != NULL;
  if (strcmp(word, "program") == 0) return (table->program = Copy(rest)) != NULL;
  if (strcmp(word, "ports") == 0) return (table->ports = Copy(rest)) != NULL;
  if (strcmp(word, "rate_hz") == 0) table->rate_hz = FromBits(rest);
  if (strcmp(word, "agents") == 0) table->agents = strtoull(rest, NULL, 10);
  if (strcmp(word, "figures") == 0) table->figures = strtoull(rest, NULL, 10);
  if (strcmp(word, "actions") == 0) table->actions = strtoull(rest, NULL, 10);
  if (strcmp(word, "hello") == 0 && table->expectations < 4) {
    char** pair = table->expected + 2 * table->expectations++;
    pair[0] = Copy(NextWord(&rest));
    pair[1] = Copy(rest);
    return pair[0] != NULL && pair[1] != NULL;
  }
  return true;
}

static FILE* OpenToRead(const char* path) {
#if defined(_WIN32)
  wchar_t wide[4096];
  if (MultiByteToWideChar(CP_UTF8, 0, path, -1, wide, 4096) == 0) return NULL;
  return _wfopen(wide, L"rb");
#else
  return fopen(path, "rbe"); /* e: no child inherits it */
#endif
}

/* Reads the table. Returns false if the file is not there or not whole. */
static bool ReadTable(Table* table, const char* path) {
  static const char first[] = "mascot fmu 1\n", last[] = "end\n";
  char piece[4096];
  size_t size;
  Text text = {NULL, 0, 0, false};
  bool is_whole;
  FILE* file = OpenToRead(path);
  if (file == NULL) return false;
  while ((size = fread(piece, 1, sizeof piece, file)) > 0) AddBytes(&text, piece, size);
  is_whole = !ferror(file) && !text.failed && text.size >= sizeof first + sizeof last - 2 &&
             memcmp(text.at, first, sizeof first - 1) == 0 &&
             memcmp(text.at + text.size - (sizeof last - 1), last, sizeof last - 1) == 0;
  fclose(file);
  if (is_whole) {
    char *line = text.at + sizeof first - 1, *end;
    for (; is_whole && (end = strchr(line, '\n')) != NULL; line = end + 1) {
      *end = '\0';
      is_whole = ReadLine(table, line);
    }
  }
  Clear(&text);
  return is_whole && table->token != NULL && table->ports != NULL && table->program != NULL;
}

/* ------------------------------------------------------------------------------------------------------------------
 * An instance.
 */

/* What an instance is in: which calls are legal is said by sets of these. */
typedef enum {
  INSTANTIATED = 1,
  INITIALIZING = 2,
  STEPPING = 4,
  STOPPED = 8, /* a step was discarded: the episode is over */
  FAILED = 16,
  TERMINATED = 32,
  DEAD = 64
} Mode;
enum { ALIVE = INSTANTIATED | INITIALIZING | STEPPING | STOPPED | FAILED | TERMINATED };

static const struct {
  Mode mode;
  const char* words;
} kModes[] = {{INSTANTIATED, "before its initialization"},
              {INITIALIZING, "in its initialization"},
              {STEPPING, "between steps"},
              {STOPPED, "at the end of its episode"},
              {FAILED, "after an error"},
              {TERMINATED, "after its end"}};

/* Categories of log messages. */
enum { LOG_WARNING = 1, LOG_DISCARD = 2, LOG_ERROR = 4, LOG_FATAL = 8 };
static const struct {
  const char* name;
  int bits;
} kCategories[] = {{"logStatusWarning", LOG_WARNING},
                   {"logStatusDiscard", LOG_DISCARD},
                   {"logStatusError", LOG_ERROR},
                   {"logStatusFatal", LOG_FATAL},
                   {"logAll", 15}};

/* What SetFMUstate brings back, beside the values of variables. */
typedef struct {
  Mode mode;
  double start_time, time;
  int64_t tick;
  bool is_over;
} Position;

/* A state that the tool keeps. */
typedef struct State {
  struct State* next; /* of the instance's states */
  Position at;
  Value* values;
  double *given, *held;
  bool* changed;
  bool has_episode;
  int64_t snapshot; /* the server's number of the episode so far; 0: `text` has it */
  char* text;       /* as the server gives it; null: none */
} State;

typedef struct {
  char* name;
  void* environment;
  Logger2 logger2;
  Logger3 logger3;       /* null: the instance is of FMI 2 */
  int log;               /* categories */
  bool may_return_early; /* the tool lets a step end before its time */
  Table table;
  char* resources;

  Position at;
  Value* values; /* of all variables */
  double* held;  /* actions in force at the tick */
  double* given; /* actions that the server has */
  bool* changed; /* keys to be set before the next tick */
  bool is_begun; /* the server's episode has begun with these parameters */

  Socket socket;
  int output;  /* of a started server; -1: none */
  long child;  /* its process; 0: none */
  Text said;   /* what a started server printed last */
  Text in;     /* bytes that have come, not yet read */
  size_t kept; /* snapshots that the server keeps */
  State* states;
  bool has_sockets; /* Windows: WSAStartup was called */
} Instance;

static const char* TypeName(const Instance* instance, int type) {
  int place = type == TYPE_REAL ? 0 : type == TYPE_INTEGER ? 1 : type == TYPE_BOOLEAN ? 2 : 3;
  return instance->logger3 != NULL ? kTypeNames3[place] : kTypeNames2[place];
}

static void Log(const Instance* instance, int status, int category, const char* words) {
  size_t k = 0;
  while (kCategories[k].bits != category) ++k;
  if (instance->logger3 != NULL) {
    instance->logger3(instance->environment, status, kCategories[k].name, words);
  } else if (instance->logger2 != NULL) { /* the message is a format of printf */
    Text format = {NULL, 0, 0, false};
    for (; *words != '\0'; ++words) AddBytes(&format, *words == '%' ? "%%" : words, *words == '%' ? 2 : 1);
    if (format.at != NULL)
      instance->logger2(instance->environment, instance->name, status, kCategories[k].name, format.at);
    Clear(&format);
  }
}

/* Tells the tool what is wrong. Errors are told whether it wants to hear of them or not. Returns `status`. */
static int Fail(Instance* instance, int status, const char* format, ...) LIKE_PRINTF(3, 4);
static int Fail(Instance* instance, int status, const char* format, ...) {
  static const int categories[] = {0, LOG_WARNING, LOG_DISCARD, LOG_ERROR, LOG_FATAL};
  char words[4096];
  va_list rest;
  va_start(rest, format);
  vsnprintf(words, sizeof words, format, rest);
  va_end(rest);
  if (status >= ERRED || (instance->log & categories[status]) != 0) Log(instance, status, categories[status], words);
  if (status == FATAL) instance->at.mode = DEAD;
  return status;
}

/* The variable with a role that only one has. */
static Value* ValueOf(const Instance* instance, Role role) {
  size_t k = 0;
  while (instance->table.variables[k].role != role) ++k;
  return &instance->values[k];
}

/* ------------------------------------------------------------------------------------------------------------------
 * Time and sockets.
 */

static double Now_s(void) {
#if defined(_WIN32)
  return (double)GetTickCount64() / 1000;
#else
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
#endif
}

static double Deadline_s(const Instance* instance) { return Now_s() + ValueOf(instance, ROLE_TIMEOUT)->real; }

static int MillisecondsTo(double deadline_s) {
  double rest = (deadline_s - Now_s()) * 1000;
  return rest < 0 ? 0 : rest > 100000 ? 100000 : (int)rest + 1;
}

static void CloseSocket(Instance* instance) {
  if (instance->socket == NO_SOCKET) return;
#if defined(_WIN32)
  closesocket(instance->socket);
#else
  close(instance->socket);
#endif
  instance->socket = NO_SOCKET;
}

/* The last complete lines that a started server printed, or what it said of its mistake. */
static const char* LastWords(const Instance* instance) {
  const char *words = instance->said.at == NULL ? "" : instance->said.at, *error = NULL, *at;
  for (at = words; (at = strstr(at, "error: ")) != NULL; at += 7)
    if (at == words || at[-1] == '\n') error = at;
  return error != NULL ? error + 7 : words;
}

#if defined(STARTS_SERVERS)
/* Reads what a started server prints, and hands on its lines. Returns false at the end of it. */
static bool Drain(Instance* instance) {
  char piece[4096];
  ssize_t size;
  while ((size = read(instance->output, piece, sizeof piece)) > 0) {
    AddBytes(&instance->said, piece, (size_t)size);
    if (instance->said.size > 16384) DropFront(&instance->said, instance->said.size - 8192);
  }
  return size < 0 && (errno == EAGAIN || errno == EINTR);
}
#endif

/* Waits until the socket can be read (or written). Meanwhile reads what a started server prints, so that it is never
 * held up. Returns 1: it can be, 0: the time is over. */
static int AwaitSocket(Instance* instance, bool to_write, double deadline_s) {
  for (;;) {
#if defined(_WIN32)
    WSAPOLLFD watched[2];
    int ready;
    watched[0].fd = instance->socket;
    watched[0].events = to_write ? POLLWRNORM : POLLRDNORM;
    watched[0].revents = 0;
    ready = WSAPoll(watched, 1, MillisecondsTo(deadline_s));
    if (ready > 0) return 1;
#else
    struct pollfd watched[2];
    nfds_t count = instance->output >= 0 ? 2 : 1;
    memset(watched, 0, sizeof watched);
    watched[0].fd = instance->socket;
    watched[0].events = to_write ? POLLOUT : POLLIN;
    watched[1].fd = instance->output;
    watched[1].events = POLLIN;
    if (poll(watched, count, MillisecondsTo(deadline_s)) < 0 && errno != EINTR) return 0;
#if defined(STARTS_SERVERS)
    if (count == 2 && watched[1].revents != 0 && !Drain(instance)) {
      close(instance->output);
      instance->output = -1;
    }
#endif
    if (watched[0].revents != 0) return 1;
#endif
    if (Now_s() >= deadline_s) return 0;
  }
}

/* ------------------------------------------------------------------------------------------------------------------
 * The end of the server, and its start.
 */

static void EndServer(Instance* instance) {
  CloseSocket(instance);
  instance->in.size = 0;
  instance->kept = 0;
  instance->is_begun = false;
#if defined(STARTS_SERVERS)
  if (instance->child != 0) {
    /* It ends by itself, as its client is gone; a signal tells it so during a long step, too. */
    const double deadline_s = Now_s() + 10;
    pid_t child = (pid_t)instance->child, ended = 0;
    int status;
    kill(child, SIGTERM);
    while ((ended = waitpid(child, &status, WNOHANG)) == 0 && Now_s() < deadline_s) {
      struct pollfd watched;
      watched.fd = instance->output; /* which it closes at its end; -1 only waits */
      watched.events = POLLIN;
      watched.revents = 0;
      poll(&watched, 1, 5);
      if (watched.revents != 0 && !Drain(instance)) {
        close(instance->output);
        instance->output = -1;
      }
    }
    if (ended == 0) {
      kill(child, SIGKILL);
      while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
    }
    instance->child = 0;
  }
  if (instance->output >= 0) Drain(instance);
#endif
#if !defined(_WIN32)
  if (instance->output >= 0) close(instance->output);
#endif
  instance->output = -1;
}

/* The server does not answer: nothing can go on. */
static int LoseServer(Instance* instance, const char* why) {
  const bool is_ours = instance->child != 0;
  EndServer(instance);
  if (is_ours && instance->said.size > 0) return Fail(instance, FATAL, "%s; it said: %s", why, LastWords(instance));
  return Fail(instance, FATAL, "%s", why);
}

#if defined(STARTS_SERVERS)
/* Starts the program. Returns 0, or why it cannot be started. */
static int Spawn(Instance* instance, const char* program, int output) {
  const char* engine = ValueOf(instance, ROLE_ENGINE)->text;
  Text experiment = {NULL, 0, 0, false};
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  sigset_t none, usual;
  pid_t child = 0;
  int error;
  char* words[12];
  size_t count = 0;
  AddWords(&experiment, instance->resources);
  AddWords(&experiment, "/experiment.toml");
  if (experiment.failed) {
    Clear(&experiment);
    return ENOMEM;
  }
  words[count++] = (char*)program;
  words[count++] = (char*)"serve";
  words[count++] = experiment.at;
  words[count++] = (char*)"--at";
  words[count++] = (char*)"127.0.0.1:0";
  words[count++] = (char*)"--json";
  words[count++] = (char*)"--once";
  if (strcmp(engine, "inprocess") != 0) { /* what serve does otherwise */
    words[count++] = (char*)"--engine";
    words[count++] = (char*)engine;
  }
  words[count] = NULL;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, output, 1);
  posix_spawn_file_actions_adddup2(&actions, output, 2);
  posix_spawnattr_init(&attributes);
  sigemptyset(&none);
  sigfillset(&usual);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &usual);
  posix_spawnattr_setpgroup(&attributes, 0); /* Ctrl-C in the tool's terminal is the tool's affair */
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  error = posix_spawnp(&child, program, &actions, &attributes, words, environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  Clear(&experiment);
  if (error == 0) instance->child = child;
  return error;
}
#endif

/* Starts a server, if none is given or started, and does not wait for it. */
static int StartServer(Instance* instance) {
  if (*ValueOf(instance, ROLE_ADDRESS)->text != '\0' || instance->child != 0) return OK;
#if defined(STARTS_SERVERS)
  {
    const char* program = ValueOf(instance, ROLE_ORCHESTRATOR)->text;
    int ends[2], error;
    Clear(&instance->said);
    if (pipe2(ends, O_CLOEXEC) != 0) return Fail(instance, ERRED, "cannot start \"%s\": %s", program, strerror(errno));
    instance->output = ends[0];
    fcntl(ends[0], F_SETFL, O_NONBLOCK);
    error = Spawn(instance, program, ends[1]);
    if (error != 0 && strcmp(program, "orchestrator") == 0) error = Spawn(instance, instance->table.program, ends[1]);
    close(ends[1]);
    if (error == 0) return OK;
    close(instance->output);
    instance->output = -1;
    return Fail(instance, ERRED,
                "cannot start \"%s\": %s; the parameter \"orchestrator\" names the program, or \"address\" a server",
                program, strerror(error));
  }
#else
  return Fail(instance, ERRED,
              "the team flies on Linux: start `orchestrator serve experiment.toml --at ADDRESS:PORT` there, with the "
              "experiment.toml in the FMU's resources, and set the parameter \"address\" to ADDRESS:PORT");
#endif
}

/* Waits until a started server says where it listens, and writes that to `address`. */
static int AwaitAddress(Instance* instance, Text* address) {
#if defined(STARTS_SERVERS)
  static const char begin[] = "{\"address\": \"";
  const double deadline_s = Deadline_s(instance);
  bool goes_on = true;
  for (;;) {
    const char *at = instance->said.at == NULL ? NULL : strstr(instance->said.at, begin), *end;
    if (at != NULL && (end = strchr(at + sizeof begin - 1, '"')) != NULL) {
      AddBytes(address, at + sizeof begin - 1, (size_t)(end - at) - (sizeof begin - 1));
      Clear(&instance->said);
      return OK;
    }
    if (!goes_on) {
      EndServer(instance);
      return Fail(instance, ERRED, "orchestrator serve: %s",
                  instance->said.size > 0 ? LastWords(instance) : "it ended without a word");
    }
    if (Now_s() >= deadline_s) {
      EndServer(instance);
      return Fail(instance, ERRED, "orchestrator serve has not begun to listen within timeout_s = %g s",
                  ValueOf(instance, ROLE_TIMEOUT)->real);
    }
    {
      struct pollfd watched;
      watched.fd = instance->output;
      watched.events = POLLIN;
      watched.revents = 0;
      if (poll(&watched, 1, MillisecondsTo(deadline_s)) > 0) goes_on = Drain(instance);
    }
  }
#else
  (void)address;
  return Fail(instance, ERRED, "no server was started");
#endif
}

static bool SetNonBlocking(Socket socket_) {
#if defined(_WIN32)
  u_long on = 1;
  return ioctlsocket(socket_, FIONBIO, &on) == 0;
#else
  return fcntl(socket_, F_SETFL, O_NONBLOCK) == 0 && fcntl(socket_, F_SETFD, FD_CLOEXEC) == 0;
#endif
}

static Socket OpenSocket(int family) {
#if defined(__linux__)
  return socket(family, SOCK_STREAM | SOCK_CLOEXEC, IPPROTO_TCP);
#else
  return socket(family, SOCK_STREAM, IPPROTO_TCP);
#endif
}

/* Connects to one of the addresses. */
static bool ConnectTo(Instance* instance, const struct addrinfo* to, double deadline_s) {
  int on = 1, error = 0;
#if defined(_WIN32)
  int size = sizeof error;
#else
  socklen_t size = sizeof error;
#endif
  instance->socket = OpenSocket(to->ai_family);
  if (instance->socket == NO_SOCKET) return false;
  SetNonBlocking(instance->socket);
  setsockopt(instance->socket, IPPROTO_TCP, TCP_NODELAY, (const char*)&on, sizeof on);
#if defined(SO_NOSIGPIPE)
  setsockopt(instance->socket, SOL_SOCKET, SO_NOSIGPIPE, (const char*)&on, sizeof on);
#endif
#if defined(_WIN32)
  if (connect(instance->socket, to->ai_addr, (int)to->ai_addrlen) == 0) return true;
  if (WSAGetLastError() == WSAEWOULDBLOCK && AwaitSocket(instance, true, deadline_s) &&
      getsockopt(instance->socket, SOL_SOCKET, SO_ERROR, (char*)&error, &size) == 0 && error == 0)
    return true;
#else
  if (connect(instance->socket, to->ai_addr, to->ai_addrlen) == 0) return true;
  if (errno == EINPROGRESS && AwaitSocket(instance, true, deadline_s) &&
      getsockopt(instance->socket, SOL_SOCKET, SO_ERROR, &error, &size) == 0 && error == 0)
    return true;
  if (error != 0) errno = error;
#endif
  error = errno;
  CloseSocket(instance);
  errno = error;
  return false;
}

/* Connects to "HOST:PORT", or "[HOST]:PORT" with an address of IPv6. */
static int Connect(Instance* instance, const char* address) {
  const double deadline_s = Deadline_s(instance);
  const char* colon = strrchr(address, ':');
  struct addrinfo hints, *found = NULL, *each;
  Text host = {NULL, 0, 0, false};
  bool is_in_brackets, is_connected = false;
  if (colon == NULL || colon == address || colon[1] == '\0')
    return Fail(instance, ERRED, "address: expected ADDRESS:PORT, got \"%s\"", address);
#if defined(_WIN32)
  {
    WSADATA data;
    if (!instance->has_sockets && WSAStartup(MAKEWORD(2, 2), &data) != 0)
      return Fail(instance, ERRED, "Windows gives no sockets");
    instance->has_sockets = true;
  }
#endif
  is_in_brackets = address[0] == '[' && colon[-1] == ']';
  AddBytes(&host, address + is_in_brackets, (size_t)(colon - address) - (is_in_brackets ? 2u : 0u));
  if (host.failed) return Fail(instance, FATAL, "no memory");
  memset(&hints, 0, sizeof hints);
  hints.ai_socktype = SOCK_STREAM;
  if (getaddrinfo(host.at, colon + 1, &hints, &found) != 0) {
    Clear(&host);
    return Fail(instance, ERRED, "address: no host or port has the name \"%s\"", address);
  }
  Clear(&host);
  for (each = found; each != NULL && !is_connected; each = each->ai_next)
    is_connected = ConnectTo(instance, each, deadline_s);
  freeaddrinfo(found);
  if (is_connected) return OK;
#if defined(_WIN32)
  return Fail(instance, ERRED, "address: no server answers at %s", address);
#else
  return Fail(instance, ERRED, "address: no server answers at %s: %s", address, strerror(errno));
#endif
}

/* ------------------------------------------------------------------------------------------------------------------
 * Messages: lines of JSON until hello is answered, and then frames (docs/serve.md).
 */

static int Send(Instance* instance, const char* bytes, size_t size) {
  const double deadline_s = Deadline_s(instance);
#if defined(MSG_NOSIGNAL)
  const int flags = MSG_NOSIGNAL;
#else
  const int flags = 0;
#endif
  while (size > 0) {
#if defined(_WIN32)
    int sent = send(instance->socket, bytes, size > INT_MAX ? INT_MAX : (int)size, flags);
    const bool waits = sent < 0 && WSAGetLastError() == WSAEWOULDBLOCK;
#else
    ssize_t sent = send(instance->socket, bytes, size, flags);
    const bool waits = sent < 0 && (errno == EAGAIN || errno == EINTR);
#endif
    if (sent >= 0) {
      bytes += sent;
      size -= (size_t)sent;
    } else if (!waits) {
      return LoseServer(instance, "the server has ended");
    } else if (!AwaitSocket(instance, true, deadline_s)) {
      return LoseServer(instance, "the server reads nothing within timeout_s");
    }
  }
  return OK;
}

/* Reads until `instance->in` has `size` bytes, or, with 0, an end of line. */
static int Receive(Instance* instance, size_t size) {
  const double deadline_s = Deadline_s(instance);
  while (size > 0 ? instance->in.size < size
                  : instance->in.size == 0 || memchr(instance->in.at, '\n', instance->in.size) == NULL) {
    char piece[65536];
#if defined(_WIN32)
    int came = recv(instance->socket, piece, sizeof piece, 0);
    const bool waits = came < 0 && WSAGetLastError() == WSAEWOULDBLOCK;
#else
    ssize_t came = recv(instance->socket, piece, sizeof piece, 0);
    const bool waits = came < 0 && (errno == EAGAIN || errno == EINTR);
#endif
    if (came > 0)
      AddBytes(&instance->in, piece, (size_t)came);
    else if (!waits)
      return LoseServer(instance, "the server has ended");
    else if (!AwaitSocket(instance, false, deadline_s)) {
      char words[100];
      snprintf(words, sizeof words, "the server has not answered within timeout_s = %g s",
               ValueOf(instance, ROLE_TIMEOUT)->real);
      return LoseServer(instance, words);
    }
    if (instance->in.failed) return LoseServer(instance, "no memory");
  }
  return OK;
}

static uint32_t Unsigned32(const char* at) {
  const unsigned char* bytes = (const unsigned char*)at;
  return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static uint64_t Unsigned64(const char* at) { return Unsigned32(at) | (uint64_t)Unsigned32(at + 4) << 32; }

static double Double(const char* at) {
  uint64_t bits = Unsigned64(at);
  double number;
  memcpy(&number, &bits, sizeof number);
  return number;
}

static void AddUnsigned(Text* text, uint64_t number, int bytes) {
  for (; bytes > 0; --bytes, number >>= 8) {
    const char byte = (char)(unsigned char)(number & 0xFF);
    AddBytes(text, &byte, 1);
  }
}

static void AddDouble(Text* text, double number) {
  uint64_t bits;
  memcpy(&bits, &number, sizeof bits);
  AddUnsigned(text, bits, 8);
}

/* Sends a frame, and reads the one that answers it to `content`. */
static int Exchange(Instance* instance, char kind, const Text* request, char* answer_kind, Text* content) {
  enum { HEAD = 5, LARGEST = 1 << 28 };
  Text frame = {NULL, 0, 0, false};
  int status;
  size_t size;
  AddUnsigned(&frame, (uint64_t)request->size + 1, 4);
  AddBytes(&frame, &kind, 1);
  AddBytes(&frame, request->at, request->size);
  status = request->failed || frame.failed ? LoseServer(instance, "no memory") : Send(instance, frame.at, frame.size);
  Clear(&frame);
  if (status != OK || (status = Receive(instance, HEAD)) != OK) return status;
  size = Unsigned32(instance->in.at);
  if (size < 1 || size > LARGEST) return LoseServer(instance, "the server has not answered as docs/serve.md says");
  if ((status = Receive(instance, 4 + size)) != OK) return status;
  *answer_kind = instance->in.at[4];
  content->size = 0;
  AddBytes(content, instance->in.at + HEAD, size - 1);
  DropFront(&instance->in, 4 + size);
  return content->failed ? LoseServer(instance, "no memory") : OK;
}

/* An answer that is an error becomes one of this FMU. */
static int Refused(Instance* instance, const Text* answer) {
  Text words = {NULL, 0, 0, false};
  Piece error = JsonField(answer, "error");
  int status;
  if (error.at == NULL) return OK;
  AddFromJson(&words, error);
  status = Fail(instance, ERRED, "%s", words.at == NULL ? "" : words.at);
  Clear(&words);
  return status;
}

/* Sends a request in JSON, and reads its answer. */
static int Ask(Instance* instance, const Text* request, Text* answer) {
  char kind = 'J';
  int status = Exchange(instance, 'J', request, &kind, answer);
  if (status == OK && kind != 'J') return LoseServer(instance, "the server has not answered as docs/serve.md says");
  return status != OK ? status : Refused(instance, answer);
}

static int AskWords(Instance* instance, const char* words, Text* answer) {
  Text request = {NULL, 0, 0, false};
  int status;
  AddWords(&request, words);
  status = Ask(instance, &request, answer);
  Clear(&request);
  return status;
}

/* Says hello, in lines, after which frames are sent. */
static int SayHello(Instance* instance) {
  static const char hello[] = "{\"request\":\"hello\",\"protocol\":1,\"form\":\"binary\"}\n";
  Text line = {NULL, 0, 0, false};
  size_t size;
  int status = Send(instance, hello, sizeof hello - 1);
  if (status != OK || (status = Receive(instance, 0)) != OK) return status;
  size = (size_t)((char*)memchr(instance->in.at, '\n', instance->in.size) - instance->in.at);
  AddBytes(&line, instance->in.at, size);
  DropFront(&instance->in, size + 1);
  status = line.failed ? LoseServer(instance, "no memory") : Refused(instance, &line);
  Clear(&line);
  return status;
}

/* Whether the team there is that of this FMU. */
static int CompareTeam(Instance* instance) {
  Text answer = {NULL, 0, 0, false};
  int status = AskWords(instance, "{\"request\":\"hello\",\"protocol\":1,\"form\":\"binary\"}", &answer);
  size_t k;
  for (k = 0; status == OK && k < instance->table.expectations; ++k) {
    const char *name = instance->table.expected[2 * k], *expected = instance->table.expected[2 * k + 1];
    const Piece got = JsonField(&answer, name);
    if (!IsPiece(got, expected))
      status = Fail(instance, ERRED, "the server has another team: \"%s\" is %.*s, and %s in this FMU", name,
                    got.at == NULL   ? 0
                    : got.size > 500 ? 500
                                     : (int)got.size,
                    got.at == NULL ? "" : got.at, expected);
  }
  Clear(&answer);
  return status;
}

/* ------------------------------------------------------------------------------------------------------------------
 * The episode.
 */

/* Takes over a state of the team. */
static int TakeState(Instance* instance, const Text* content, bool* has_failed) {
  const Table* table = &instance->table;
  const char *at = content->at, *end = content->at + content->size;
  const char** agents = NULL;
  size_t k;
  bool is_whole = content->size >= 20 && Unsigned32(at + 12) == table->agents && Unsigned32(at + 16) == table->figures;
  if (is_whole) {
    agents = calloc(table->agents + 1, sizeof *agents);
    if (agents == NULL) return LoseServer(instance, "no memory");
    for (k = 0, at += 20 + 8 * table->figures; is_whole && k < table->agents; ++k) {
      agents[k] = at;
      is_whole = at + 112 <= end && Unsigned32(at + 108) <= (size_t)(end - at - 112) / 4;
      if (is_whole) at += 112 + 4 * (size_t)Unsigned32(at + 108);
    }
    is_whole = is_whole && at == end;
  }
  if (!is_whole) {
    free((void*)agents);
    return LoseServer(instance, "the server has not answered as docs/serve.md says");
  }
  instance->at.tick = (int64_t)Unsigned64(content->at);
  instance->at.is_over = (Unsigned32(content->at + 8) & 1) != 0;
  *has_failed = (Unsigned32(content->at + 8) & 2) != 0;
  for (k = 0; k < table->count; ++k) {
    const Variable* variable = &table->variables[k];
    Value* value = &instance->values[k];
    const char* agent = variable->role >= ROLE_STATE ? agents[variable->agent] : NULL;
    if (variable->role == ROLE_TICK) value->whole = instance->at.tick;
    if (variable->role == ROLE_END) value->whole = instance->at.is_over;
    if (variable->role == ROLE_FIGURE) value->real = Double(content->at + 20 + (size_t)8 * (size_t)variable->index);
    if (variable->role == ROLE_STATE) value->real = Double(agent + (size_t)8 * (size_t)variable->index);
    if (variable->role == ROLE_LOST) value->whole = Unsigned32(agent + 104) != 0;
    if (variable->role == ROLE_COUNT) value->whole = Unsigned32(agent + 108);
    if (variable->role == ROLE_HEARD) {
      const uint32_t count = Unsigned32(agent + 108);
      uint32_t n;
      value->whole = 0;
      for (n = 0; n < count; ++n)
        value->whole |= Unsigned32(agent + 112 + (size_t)4 * n) == (uint32_t)variable->index + 1;
    }
  }
  free((void*)agents);
  return OK;
}

/* Why the episode has failed, in the server's words. */
static int TellFailure(Instance* instance) {
  Text answer = {NULL, 0, 0, false}, words = {NULL, 0, 0, false};
  int status = AskWords(instance, "{\"request\":\"look\"}", &answer);
  if (status == OK) {
    AddFromJson(&words, JsonField(&answer, "failure"));
    status = Fail(instance, ERRED, "the episode has failed: %s", words.at == NULL ? "" : words.at);
  }
  Clear(&words);
  Clear(&answer);
  return status;
}

/* Flies `ticks`, with new actions from the first on, if the server has others. */
static int Fly(Instance* instance, int64_t ticks) {
  const size_t actions = instance->table.actions;
  Text request = {NULL, 0, 0, false}, answer = {NULL, 0, 0, false};
  bool has_failed = false;
  char kind = 'S';
  size_t k;
  int status;
  AddUnsigned(&request, (uint64_t)ticks, 4);
  if (actions > 0 && memcmp(instance->given, instance->held, actions * sizeof *instance->held) != 0)
    for (k = 0; k < actions; ++k) AddDouble(&request, instance->held[k]);
  status = Exchange(instance, 'S', &request, &kind, &answer);
  if (status == OK && kind == 'S')
    status = TakeState(instance, &answer, &has_failed);
  else if (status == OK)
    status = Refused(instance, &answer);
  if (status == OK && actions > 0) memcpy(instance->given, instance->held, actions * sizeof *instance->held);
  if (status == OK && has_failed) status = TellFailure(instance);
  Clear(&request);
  Clear(&answer);
  return status;
}

/* Adds "KEY":VALUE of a live key. */
static void AddKey(Text* text, const Instance* instance, const LiveKey* key) {
  size_t next = key->first;
  const char* at;
  AddJsonText(text, key->path);
  AddWords(text, ":");
  for (at = key->template; *at != '\0'; ++at) {
    const Variable* variable = &instance->table.variables[next];
    const Value* value = &instance->values[next];
    if (*at != '%') {
      AddBytes(text, at, 1);
      continue;
    }
    ++next;
    if (variable->type == TYPE_REAL) AddNumber(text, value->real);
    if (variable->type == TYPE_INTEGER) AddInteger(text, value->whole);
    if (variable->type == TYPE_BOOLEAN) AddWords(text, value->whole ? "true" : "false");
    if (variable->type == TYPE_STRING) AddJsonText(text, value->text);
  }
}

static bool IsEqual(int type, const Value* a, const Value* b) {
  if (type == TYPE_REAL) return a->real == b->real;
  return type == TYPE_STRING ? strcmp(a->text, b->text) == 0 : a->whole == b->whole;
}

/* Whether the key has another value than in the file. */
static bool IsSet(const Instance* instance, size_t key) {
  const Table* table = &instance->table;
  size_t k;
  for (k = table->keys[key].first; k < table->count && table->variables[k].role == ROLE_KEY; ++k) {
    const Variable* variable = &table->variables[k];
    if ((size_t)variable->index != key) break;
    if (!IsEqual(variable->type, &instance->values[k], &variable->start)) return true;
  }
  return false;
}

/* Gives the server the keys that have changed: an event at the next tick. */
static int SendKeys(Instance* instance) {
  Text request = {NULL, 0, 0, false}, answer = {NULL, 0, 0, false};
  size_t k, count = 0;
  int status = OK;
  AddWords(&request, "{\"request\":\"set\",\"set\":{");
  for (k = 0; k < instance->table.key_count; ++k) {
    if (!instance->changed[k]) continue;
    if (count++ > 0) AddWords(&request, ",");
    AddKey(&request, instance, &instance->table.keys[k]);
    instance->changed[k] = false;
  }
  AddWords(&request, "}}");
  if (count > 0) status = Ask(instance, &request, &answer);
  Clear(&request);
  Clear(&answer);
  return status;
}

/* A started server ends by itself if no client comes for long, as while a tool waits in its initialization. */
static void ForgetEndedServer(Instance* instance) {
#if defined(STARTS_SERVERS)
  int status;
  if (instance->child == 0) return;
  Drain(instance);
  if (instance->said.at == NULL || strstr(instance->said.at, "{\"address\": ") == NULL) return; /* it says why */
  if (waitpid((pid_t)instance->child, &status, WNOHANG) != (pid_t)instance->child) return;
  instance->child = 0;
  EndServer(instance);
#else
  (void)instance;
#endif
}

/* Makes sure that there is a server, which has been greeted. */
static int Reach(Instance* instance) {
  Text address = {NULL, 0, 0, false};
  int status;
  if (instance->socket != NO_SOCKET) return OK;
  ForgetEndedServer(instance);
  AddWords(&address, ValueOf(instance, ROLE_ADDRESS)->text);
  status = StartServer(instance);
  if (status == OK && address.size == 0) status = AwaitAddress(instance, &address);
  if (status == OK) status = Connect(instance, address.at);
  if (status == OK) status = SayHello(instance);
  Clear(&address);
  if (status == ERRED) EndServer(instance);
  return status;
}

/* Begins an episode with these parameters, if that has not been done. */
static int Begin(Instance* instance) {
  Text request = {NULL, 0, 0, false}, answer = {NULL, 0, 0, false};
  size_t k, count = 0;
  int status;
  if (instance->is_begun) return OK;
  if ((status = Reach(instance)) != OK) return status;
  AddWords(&request, "{\"request\":\"reset\",\"seed\":");
  AddInteger(&request, ValueOf(instance, ROLE_SEED)->whole);
  AddWords(&request, ",\"ports\":");
  AddWords(&request, instance->table.ports);
  AddWords(&request, ",\"set\":{");
  for (k = 0; k < instance->table.key_count; ++k) {
    instance->changed[k] = false;
    if (!IsSet(instance, k)) continue;
    if (count++ > 0) AddWords(&request, ",");
    AddKey(&request, instance, &instance->table.keys[k]);
  }
  AddWords(&request, "}}");
  status = Ask(instance, &request, &answer);
  Clear(&request);
  Clear(&answer);
  for (k = 0; k < instance->table.actions; ++k) instance->given[k] = instance->held[k] = 0;
  if (status == OK) status = CompareTeam(instance);
  if (status == OK) status = Fly(instance, 0);
  instance->is_begun = status == OK;
  return status;
}

static double TimeOfTick(const Instance* instance) {
  return instance->at.start_time + (double)instance->at.tick / instance->table.rate_hz;
}

/* The inputs of the communication point are in force from now on. */
static void HoldInputs(Instance* instance) {
  size_t k;
  for (k = 0; k < instance->table.count; ++k)
    if (instance->table.variables[k].role == ROLE_ACTION)
      instance->held[instance->table.variables[k].index] = instance->values[k].real;
}

/* The largest whole number that is not above `ticks`, without libm, which a tool may not link. */
static int64_t WholeTicks(double ticks) {
  const double most = 9e15;
  int64_t whole;
  if (ticks > most) ticks = most;
  if (ticks < -most) ticks = -most;
  whole = (int64_t)ticks;
  return (double)whole > ticks ? whole - 1 : whole;
}

/* A step of time: flies the ticks up to its end. At a tick, agents take the inputs of the last communication point that
 * is not later. `*ends` says whether the episode ends before the step does. */
static int Step(Instance* instance, double from, double step, bool* ends) {
  enum { MOST = 1000 }; /* ticks of one request, whose answer must come within timeout_s */
  const double rate_hz = instance->table.rate_hz, hair = 1e-6 / rate_hz;
  const double tolerance_s = 1e-3 / rate_hz + 1e-9 * fabs(from);
  int64_t last;
  int status;
  *ends = false;
  if (!isfinite(from) || fabs(from - instance->at.time) > tolerance_s)
    return Fail(instance, ERRED, "a step must begin at %.17g s, where the one before has ended, not at %.17g s",
                instance->at.time, from);
  if (!isfinite(step) || step <= 0) return Fail(instance, ERRED, "a step must be longer than 0 s, got %.17g s", step);
  last = WholeTicks((from + step - instance->at.start_time) * rate_hz + 1e-6);
  if (TimeOfTick(instance) >= from - hair) HoldInputs(instance);
  if (instance->at.tick < last && !instance->at.is_over && (status = SendKeys(instance)) != OK) return status;
  while (instance->at.tick < last && !instance->at.is_over) {
    const bool inputs_are_later = TimeOfTick(instance) < from - hair;
    const int64_t before = instance->at.tick, left = last - before;
    if ((status = Fly(instance, inputs_are_later ? 1 : left < MOST ? left : MOST)) != OK) return status;
    if (instance->at.tick == before && !instance->at.is_over)
      return LoseServer(instance, "the server does not go on: it was told to end");
    if (inputs_are_later) HoldInputs(instance);
  }
  *ends = instance->at.tick < last;
  instance->at.time = from + step;
  if (*ends) instance->at.time = TimeOfTick(instance) > from ? TimeOfTick(instance) : from;
  return OK;
}

/* ------------------------------------------------------------------------------------------------------------------
 * States that the tool keeps.
 */

static void FreeValues(const Table* table, Value* values) {
  size_t k;
  if (values == NULL) return;
  for (k = 0; k < table->count; ++k) free(values[k].text);
  free(values);
}

/* A copy of the values of all variables; null: there is no memory. */
static Value* CopyValues(const Table* table, const Value* values) {
  Value* copy = calloc(table->count + 1, sizeof *copy);
  size_t k;
  for (k = 0; copy != NULL && k < table->count; ++k) {
    copy[k] = values == NULL ? table->variables[k].start : values[k];
    if (copy[k].text != NULL && (copy[k].text = Copy(copy[k].text)) == NULL) {
      FreeValues(table, copy);
      return NULL;
    }
  }
  return copy;
}

static void FreeState(const Table* table, State* state) {
  if (state == NULL) return;
  FreeValues(table, state->values);
  free(state->given);
  free(state->held);
  free(state->changed);
  free(state->text);
  free(state);
}

static State* NewState(const Table* table) {
  State* state = calloc(1, sizeof *state);
  if (state == NULL) return NULL;
  state->given = calloc(table->actions + 1, sizeof *state->given);
  state->held = calloc(table->actions + 1, sizeof *state->held);
  state->changed = calloc(table->key_count + 1, sizeof *state->changed);
  if (state->given != NULL && state->held != NULL && state->changed != NULL) return state;
  FreeState(table, state);
  return NULL;
}

/* Asks for the text of a snapshot: that with the number, or, with 0, of the episode as it is. */
static int AskText(Instance* instance, int64_t snapshot, char** text) {
  Text request = {NULL, 0, 0, false}, answer = {NULL, 0, 0, false}, words = {NULL, 0, 0, false};
  int status;
  AddWords(&request, "{\"request\":\"snapshot\",\"form\":\"text\"");
  if (snapshot != 0) {
    AddWords(&request, ",\"snapshot\":");
    AddInteger(&request, snapshot);
  }
  AddWords(&request, "}");
  status = Ask(instance, &request, &answer);
  AddFromJson(&words, JsonField(&answer, "text"));
  if (status == OK && (words.at == NULL || words.failed)) status = LoseServer(instance, "no memory");
  if (status == OK) {
    *text = words.at;
    memset(&words, 0, sizeof words);
  }
  Clear(&words);
  Clear(&request);
  Clear(&answer);
  return status;
}

/* Drops the server's snapshot of a state. */
static int Forget(Instance* instance, State* state) {
  Text request = {NULL, 0, 0, false}, answer = {NULL, 0, 0, false};
  int status = OK;
  if (state->snapshot != 0 && instance->socket != NO_SOCKET) {
    AddWords(&request, "{\"request\":\"forget\",\"snapshot\":");
    AddInteger(&request, state->snapshot);
    AddWords(&request, "}");
    status = Ask(instance, &request, &answer);
    --instance->kept;
  }
  state->snapshot = 0;
  Clear(&request);
  Clear(&answer);
  return status;
}

/* The server keeps the episode so far, as a number while it has room, else as text. */
static int KeepEpisode(Instance* instance, State* state) {
  enum { MOST = 250 }; /* the server keeps 256 */
  Text answer = {NULL, 0, 0, false};
  int status;
  if (instance->kept >= MOST) return AskText(instance, 0, &state->text);
  status = AskWords(instance, "{\"request\":\"snapshot\"}", &answer);
  if (status == OK) {
    const Piece number = JsonField(&answer, "snapshot");
    state->snapshot = number.at == NULL ? 0 : strtoll(number.at, NULL, 10);
    ++instance->kept;
  }
  Clear(&answer);
  return status;
}

/* The server is to end: states that it keeps become text. */
static int KeepAsText(Instance* instance) {
  State* state;
  int status = OK;
  for (state = instance->states; state != NULL && status == OK; state = state->next) {
    if (state->snapshot == 0 || instance->socket == NO_SOCKET) continue;
    status = AskText(instance, state->snapshot, &state->text);
    state->snapshot = 0;
  }
  return status;
}

static bool IsState(const Instance* instance, const void* state) {
  const State* each;
  for (each = instance->states; each != NULL; each = each->next)
    if (each == state) return true;
  return false;
}

static int FreeKeptState(Instance* instance, void** state) {
  State **link, *found;
  int status;
  if (state == NULL || *state == NULL) return OK;
  for (link = &instance->states; *link != NULL && *link != *state;) link = &(*link)->next;
  if (*link == NULL) return Fail(instance, ERRED, "this is no state of this instance");
  found = *link;
  *link = found->next;
  *state = NULL;
  status = Forget(instance, found);
  FreeState(&instance->table, found);
  return status;
}

static int GetState(Instance* instance, void** place) {
  const Table* table = &instance->table;
  State* state;
  int status = OK;
  if (place == NULL) return Fail(instance, ERRED, "expected a place for the state, got null");
  if (*place != NULL && (status = FreeKeptState(instance, place)) != OK) return status;
  state = NewState(table);
  if (state == NULL || (state->values = CopyValues(table, instance->values)) == NULL) {
    FreeState(table, state);
    return Fail(instance, FATAL, "no memory");
  }
  state->at = instance->at;
  memcpy(state->given, instance->given, table->actions * sizeof *state->given);
  memcpy(state->held, instance->held, table->actions * sizeof *state->held);
  memcpy(state->changed, instance->changed, table->key_count * sizeof *state->changed);
  state->has_episode = (instance->at.mode & (STEPPING | STOPPED)) != 0;
  if (state->has_episode) status = KeepEpisode(instance, state);
  if (status != OK) {
    FreeState(table, state);
    return status;
  }
  state->next = instance->states;
  instance->states = state;
  *place = state;
  return OK;
}

/* The server goes back to the episode of a state. */
static int RestoreEpisode(Instance* instance, const State* state) {
  Text request = {NULL, 0, 0, false}, answer = {NULL, 0, 0, false};
  int status;
  if (state->snapshot == 0 && state->text == NULL)
    return Fail(instance, ERRED, "the server that kept this state has ended");
  if ((status = Reach(instance)) != OK) return status;
  AddWords(&request, "{\"request\":\"restore\",");
  if (state->text != NULL) {
    AddWords(&request, "\"text\":");
    AddJsonText(&request, state->text);
  } else {
    AddWords(&request, "\"snapshot\":");
    AddInteger(&request, state->snapshot);
  }
  AddWords(&request, "}");
  status = Ask(instance, &request, &answer);
  Clear(&request);
  Clear(&answer);
  return status;
}

/* Where a team flies is a matter of the instance, not of its state. */
static bool IsOfTheServer(Role role) { return role >= ROLE_ADDRESS && role <= ROLE_TIMEOUT; }

static int SetState(Instance* instance, void* given) {
  const Table* table = &instance->table;
  State* state = given;
  Value* values;
  size_t k;
  int status;
  if (!IsState(instance, given)) return Fail(instance, ERRED, "this is no state of this instance");
  if (state->has_episode && (status = RestoreEpisode(instance, state)) != OK) return status;
  values = CopyValues(table, state->values);
  if (values == NULL) return Fail(instance, FATAL, "no memory");
  for (k = 0; k < table->count; ++k) {
    if (!IsOfTheServer(table->variables[k].role)) continue;
    free(values[k].text);
    values[k] = instance->values[k];
    instance->values[k].text = NULL;
  }
  FreeValues(table, instance->values);
  instance->values = values;
  instance->at = state->at;
  instance->is_begun = state->has_episode;
  memcpy(instance->given, state->given, table->actions * sizeof *state->given);
  memcpy(instance->held, state->held, table->actions * sizeof *state->held);
  memcpy(instance->changed, state->changed, table->key_count * sizeof *state->changed);
  return OK;
}

/* A state as bytes: the FMU's token, where the state is, all values, and the episode as text. */
static int WriteState(Instance* instance, void* given, Text* bytes) {
  const Table* table = &instance->table;
  const State* state = given;
  char* fetched = NULL;
  const char* episode;
  size_t k;
  int status = OK;
  if (!IsState(instance, given)) return Fail(instance, ERRED, "this is no state of this instance");
  if (state->snapshot != 0) status = AskText(instance, state->snapshot, &fetched);
  if (status != OK) return status;
  episode = fetched != NULL ? fetched : state->text;
  if (state->has_episode && episode == NULL) return Fail(instance, ERRED, "the server that kept this state has ended");
  AddWords(bytes, table->token);
  AddUnsigned(bytes, (uint64_t)state->at.mode, 4);
  AddDouble(bytes, state->at.start_time);
  AddDouble(bytes, state->at.time);
  AddUnsigned(bytes, (uint64_t)state->at.tick, 8);
  AddUnsigned(bytes, state->at.is_over, 1);
  AddUnsigned(bytes, state->has_episode, 1);
  for (k = 0; k < table->actions; ++k) AddDouble(bytes, state->given[k]);
  for (k = 0; k < table->actions; ++k) AddDouble(bytes, state->held[k]);
  for (k = 0; k < table->key_count; ++k) AddUnsigned(bytes, state->changed[k], 1);
  for (k = 0; k < table->count; ++k) {
    const char* text = state->values[k].text == NULL ? "" : state->values[k].text;
    AddDouble(bytes, state->values[k].real);
    AddUnsigned(bytes, (uint64_t)state->values[k].whole, 8);
    AddUnsigned(bytes, strlen(text), 8);
    AddWords(bytes, text);
  }
  AddWords(bytes, episode == NULL ? "" : episode);
  free(fetched);
  return bytes->failed ? Fail(instance, FATAL, "no memory") : OK;
}

/* The next `size` of the bytes; null: there are not so many. */
static const char* Take(Piece* bytes, size_t size) {
  const char* at = bytes->at;
  if (bytes->size < size) return NULL;
  bytes->at += size;
  bytes->size -= size;
  return at;
}

static char* TakeCopy(Piece* bytes, size_t size) {
  const char* at = Take(bytes, size);
  char* copy = at == NULL ? NULL : malloc(size + 1);
  if (copy == NULL) return NULL;
  memcpy(copy, at, size);
  copy[size] = '\0';
  return copy;
}

/* The inverse of WriteState(). Returns false for other bytes. */
static bool ReadState(const Table* table, Piece bytes, State* state) {
  const char* at = Take(&bytes, strlen(table->token));
  size_t k;
  if (at == NULL || memcmp(at, table->token, strlen(table->token)) != 0 || (at = Take(&bytes, 30)) == NULL)
    return false;
  state->at.mode = (Mode)Unsigned32(at);
  state->at.start_time = Double(at + 4);
  state->at.time = Double(at + 12);
  state->at.tick = (int64_t)Unsigned64(at + 20);
  state->at.is_over = at[28] != 0;
  state->has_episode = at[29] != 0;
  for (k = 0; k < 2 * table->actions; ++k) {
    if ((at = Take(&bytes, 8)) == NULL) return false;
    *(k < table->actions ? &state->given[k] : &state->held[k - table->actions]) = Double(at);
  }
  for (k = 0; k < table->key_count; ++k) {
    if ((at = Take(&bytes, 1)) == NULL) return false;
    state->changed[k] = *at != 0;
  }
  for (k = 0; k < table->count; ++k) {
    Value* value = &state->values[k];
    if ((at = Take(&bytes, 24)) == NULL) return false;
    value->real = Double(at);
    value->whole = (int64_t)Unsigned64(at + 8);
    free(value->text);
    value->text = NULL;
    if ((value->text = TakeCopy(&bytes, (size_t)Unsigned64(at + 16))) == NULL) return false;
  }
  if (!state->has_episode) return bytes.size == 0;
  return (state->text = TakeCopy(&bytes, bytes.size)) != NULL;
}

static int Deserialize(Instance* instance, const void* bytes, size_t size, void** place) {
  const Table* table = &instance->table;
  Piece all;
  State* state;
  int status;
  if (place == NULL || bytes == NULL) return Fail(instance, ERRED, "expected a state's bytes, got null");
  if (*place != NULL && (status = FreeKeptState(instance, place)) != OK) return status;
  state = NewState(table);
  if (state == NULL || (state->values = CopyValues(table, NULL)) == NULL) {
    FreeState(table, state);
    return Fail(instance, FATAL, "no memory");
  }
  all.at = bytes;
  all.size = size;
  if (!ReadState(table, all, state)) {
    FreeState(table, state);
    return Fail(instance, ERRED, "expected the bytes of a state of this FMU, got others");
  }
  state->next = instance->states;
  instance->states = state;
  *place = state;
  return OK;
}

static int SerializedSize(Instance* instance, void* state, size_t* size) {
  Text bytes = {NULL, 0, 0, false};
  int status = WriteState(instance, state, &bytes);
  *size = bytes.size;
  Clear(&bytes);
  return status;
}

static int Serialize(Instance* instance, void* state, void* to, size_t size) {
  Text bytes = {NULL, 0, 0, false};
  int status = WriteState(instance, state, &bytes);
  if (status == OK && size < bytes.size)
    status = Fail(instance, ERRED, "the state has %llu bytes, and there is room for %llu",
                  (unsigned long long)bytes.size, (unsigned long long)size);
  if (status == OK && bytes.at != NULL) memcpy(to, bytes.at, bytes.size);
  Clear(&bytes);
  return status;
}

/* ------------------------------------------------------------------------------------------------------------------
 * The life of an instance.
 */

/* OK if the instance is in one of the modes. */
static int Require(Instance* instance, int modes, const char* function) {
  size_t k = 0;
  if (instance == NULL) return ERRED;
  if (instance->at.mode == DEAD) return FATAL;
  if ((instance->at.mode & modes) != 0) return OK;
  while (kModes[k].mode != instance->at.mode) ++k;
  return Fail(instance, ERRED, "%s%s: not %s", instance->logger3 != NULL ? "fmi3" : "fmi2", function, kModes[k].words);
}

#define REQUIRE(modes, function)                             \
  do {                                                       \
    const int required = Require(instance, modes, function); \
    if (required != OK) return required;                     \
  } while (false)

static void Free(Instance* instance) {
  if (instance == NULL) return;
  EndServer(instance);
#if defined(_WIN32)
  if (instance->has_sockets) WSACleanup();
#endif
  while (instance->states != NULL) {
    State* state = instance->states;
    instance->states = state->next;
    FreeState(&instance->table, state);
  }
  Clear(&instance->said);
  Clear(&instance->in);
  FreeValues(&instance->table, instance->values);
  free(instance->given);
  free(instance->held);
  free(instance->changed);
  free(instance->name);
  free(instance->resources);
  FreeTable(&instance->table);
  free(instance);
}

/* The path of the folder `resources`, which FMI 2 gives as a URI. */
static char* PathOf(const char* location, bool is_uri) {
  Text path = {NULL, 0, 0, false};
  if (location == NULL) return NULL;
  if (is_uri && strncmp(location, "file:", 5) == 0) {
    location += 5;
    if (strncmp(location, "//", 2) == 0) { /* //HOST/PATH */
      location += 2;
      location += strcspn(location, "/");
    }
#if defined(_WIN32)
    if (location[0] == '/' && location[1] != '\0' && location[2] == ':') ++location;
#endif
  } else {
    is_uri = false;
  }
  AddBytes(&path, "", 0);
  for (; *location != '\0'; ++location) {
    const char* digits = "0123456789abcdef";
    const char *high, *low;
    if (is_uri && *location == '%' && location[1] != '\0' && (high = strchr(digits, location[1] | 0x20)) != NULL &&
        location[2] != '\0' && (low = strchr(digits, location[2] | 0x20)) != NULL) {
      const char byte = (char)(unsigned char)(16 * (high - digits) + (low - digits));
      AddBytes(&path, &byte, 1);
      location += 2;
    } else {
      AddBytes(&path, location, 1);
    }
  }
  while (path.size > 1 && (path.at[path.size - 1] == '/' || path.at[path.size - 1] == '\\'))
    path.at[--path.size] = '\0';
  return path.at;
}

static Instance* Instantiate(Instance* instance, const char* name, const char* token, const char* location,
                             bool is_uri) {
  Text path = {NULL, 0, 0, false};
  bool is_read;
  instance->socket = NO_SOCKET;
  instance->output = -1;
  instance->at.mode = INSTANTIATED;
  instance->name = Copy(name == NULL ? "" : name);
  instance->resources = PathOf(location, is_uri);
  if (name == NULL || *name == '\0') {
    Fail(instance, ERRED, "expected the name of an instance, got none");
  } else if (instance->resources == NULL) {
    Fail(instance, ERRED, "expected where the FMU's resources are, got null");
  } else {
    AddWords(&path, instance->resources);
    AddWords(&path, "/variables.txt");
    is_read = path.at != NULL && ReadTable(&instance->table, path.at);
    if (is_read && token != NULL && strcmp(token, instance->table.token) == 0) {
      instance->values = CopyValues(&instance->table, NULL);
      instance->given = calloc(instance->table.actions + 1, sizeof *instance->given);
      instance->held = calloc(instance->table.actions + 1, sizeof *instance->held);
      instance->changed = calloc(instance->table.key_count + 1, sizeof *instance->changed);
    } else if (is_read) {
      Fail(instance, ERRED, "the FMU's token is %s, got %s", instance->table.token, token == NULL ? "null" : token);
    } else {
      Fail(instance, ERRED, "%s: no variables of an FMU of MASCOT can be read there", path.at == NULL ? "" : path.at);
    }
    Clear(&path);
  }
  if (instance->values != NULL && instance->given != NULL && instance->held != NULL && instance->changed != NULL)
    return instance;
  Free(instance);
  return NULL;
}

static int SetLogging(Instance* instance, bool on, size_t count, const char* const categories[]) {
  int chosen = 0;
  size_t k, n;
  for (k = 0; k < count; ++k) {
    for (n = 0; n < sizeof kCategories / sizeof *kCategories; ++n) {
      if (categories[k] != NULL && strcmp(categories[k], kCategories[n].name) == 0) break;
    }
    if (n == sizeof kCategories / sizeof *kCategories)
      return Fail(instance, ERRED, "there is no log category \"%s\"", categories[k] == NULL ? "" : categories[k]);
    chosen |= kCategories[n].bits;
  }
  if (count == 0) chosen = 15;
  instance->log = on ? instance->log | chosen : instance->log & ~chosen;
  return OK;
}

static int Initialize(Instance* instance, double start_time) {
  int status;
  if (!isfinite(start_time)) return Fail(instance, ERRED, "expected a finite start time");
  instance->at.start_time = instance->at.time = start_time;
  if ((status = StartServer(instance)) == OK) instance->at.mode = INITIALIZING;
  return status;
}

static int ExitInitialization(Instance* instance) {
  int status = Begin(instance);
  if (status == OK) instance->at.mode = STEPPING;
  if (status == ERRED) instance->at.mode = FAILED;
  return status;
}

static int Terminate(Instance* instance) {
  int status = KeepAsText(instance);
  if (status == FATAL) return status;
  EndServer(instance);
  instance->at.mode = TERMINATED;
  return status;
}

static int Reset(Instance* instance) {
  Value* values;
  int status = KeepAsText(instance);
  if (status == FATAL) return status;
  EndServer(instance);
  values = CopyValues(&instance->table, NULL);
  if (values == NULL) return Fail(instance, FATAL, "no memory");
  FreeValues(&instance->table, instance->values);
  instance->values = values;
  memset(&instance->at, 0, sizeof instance->at);
  memset(instance->changed, 0, instance->table.key_count * sizeof *instance->changed);
  instance->at.mode = INSTANTIATED;
  return status;
}

/* A step, after which the instance is where it should be. */
static int DoStep(Instance* instance, double from, double step, bool* ends) {
  const int status = Step(instance, from, step, ends);
  if (status == ERRED) instance->at.mode = FAILED;
  return status;
}

/* ------------------------------------------------------------------------------------------------------------------
 * Variables, as both versions of FMI get and set them.
 */

/* The variable of a reference, which must be of this type; null after words. */
static const Variable* Find(Instance* instance, const char* function, uint32_t reference, int type) {
  const Variable* variable = instance->table.variables + reference;
  if (reference >= instance->table.count)
    Fail(instance, ERRED, "%s: no variable has the value reference %lu", function, (unsigned long)reference);
  else if (variable->type != type)
    Fail(instance, ERRED, "%s: %s is a %s, not a %s", function, variable->name, TypeName(instance, variable->type),
         TypeName(instance, type));
  else
    return variable;
  return NULL;
}

/* Where outputs are first asked for, the episode begins. */
static int BeforeGet(Instance* instance, const Variable* variable) {
  if (variable->role == ROLE_TIME) ValueOf(instance, ROLE_TIME)->real = instance->at.time;
  return variable->role >= ROLE_TICK && instance->at.mode == INITIALIZING ? Begin(instance) : OK;
}

/* Whether a variable may be set now; words if not. */
static int BeforeSet(Instance* instance, const char* function, const Variable* variable) {
  if (variable->role == ROLE_TIME || variable->role >= ROLE_TICK)
    return Fail(instance, ERRED, "%s: %s is an output, which cannot be set", function, variable->name);
  if (variable->role <= ROLE_SEED && (instance->at.mode & (INSTANTIATED | INITIALIZING)) == 0)
    return Fail(instance, ERRED, "%s: %s is fixed once the initialization is over", function, variable->name);
  return OK;
}

static void AfterSet(Instance* instance, const Variable* variable) {
  if (variable->role == ROLE_KEY) instance->changed[variable->index] = true;
  if (variable->role == ROLE_ACTION || instance->at.mode != INITIALIZING) return;
  if (IsOfTheServer(variable->role) && variable->role != ROLE_TIMEOUT) EndServer(instance); /* another one then */
  instance->is_begun = false;
}

static int SetReal(Instance* instance, const char* function, uint32_t reference, double number) {
  const Variable* variable = Find(instance, function, reference, TYPE_REAL);
  int status;
  if (variable == NULL) return ERRED;
  if ((status = BeforeSet(instance, function, variable)) != OK) return status;
  if (!isfinite(number)) return Fail(instance, ERRED, "%s: %s: expected a finite number", function, variable->name);
  if (variable->role == ROLE_TIMEOUT && (number <= 0 || number > 86400))
    return Fail(instance, ERRED, "%s: %s: expected a number in (0, 86400], got %g", function, variable->name, number);
  if (instance->values[reference].real == number) return OK;
  instance->values[reference].real = number;
  AfterSet(instance, variable);
  return OK;
}

static int SetWhole(Instance* instance, const char* function, uint32_t reference, int type, int64_t number) {
  const Variable* variable = Find(instance, function, reference, type);
  int status;
  if (variable == NULL) return ERRED;
  if ((status = BeforeSet(instance, function, variable)) != OK) return status;
  if (variable->role == ROLE_SEED && number < 0)
    return Fail(instance, ERRED, "%s: %s: expected at least 0, got %lld", function, variable->name, (long long)number);
  if (instance->values[reference].whole == number) return OK;
  instance->values[reference].whole = number;
  AfterSet(instance, variable);
  return OK;
}

static int SetText(Instance* instance, const char* function, uint32_t reference, const char* text) {
  const Variable* variable = Find(instance, function, reference, TYPE_STRING);
  char* copy;
  int status;
  if (variable == NULL) return ERRED;
  if ((status = BeforeSet(instance, function, variable)) != OK) return status;
  if (text == NULL) return Fail(instance, ERRED, "%s: %s: expected a text, got null", function, variable->name);
  if (variable->role == ROLE_ENGINE && strcmp(text, "inprocess") != 0 && strcmp(text, "dds") != 0)
    return Fail(instance, ERRED, "%s: %s: expected \"inprocess\" or \"dds\", got \"%s\"", function, variable->name,
                text);
  if (strcmp(instance->values[reference].text, text) == 0) return OK;
  if ((copy = Copy(text)) == NULL) return Fail(instance, FATAL, "no memory");
  free(instance->values[reference].text);
  instance->values[reference].text = copy;
  AfterSet(instance, variable);
  return OK;
}

enum {
  MAY_GET2 = INITIALIZING | STEPPING | STOPPED | FAILED | TERMINATED,
  MAY_GET3 = INSTANTIATED | INITIALIZING | STEPPING | STOPPED | FAILED | TERMINATED,
  MAY_SET = INSTANTIATED | INITIALIZING | STEPPING
};

/* ------------------------------------------------------------------------------------------------------------------
 * FMI 2.0
 */

#define NONE2(instance, function) \
  Fail(instance, ERRED, "fmi2" function ": this FMU has none of what the function is for")

EXPORTED const char* FMI2(GetTypesPlatform)(void) { return "default"; }
EXPORTED const char* FMI2(GetVersion)(void) { return "2.0"; }

EXPORTED void* FMI2(Instantiate)(const char* name, int type, const char* token, const char* location,
                                 const Callbacks2* callbacks, int visible, int logging_on) {
  Instance* instance = calloc(1, sizeof *instance);
  (void)visible;
  if (instance == NULL) return NULL;
  if (callbacks != NULL) {
    instance->logger2 = callbacks->logger;
    instance->environment = callbacks->environment;
  }
  instance->log = logging_on ? 15 : 0;
  if (type != 1) {
    instance->name = Copy(name == NULL ? "" : name);
    instance->socket = NO_SOCKET;
    instance->output = -1;
    Fail(instance, ERRED, "fmi2Instantiate: this FMU is for co-simulation alone");
    Free(instance);
    return NULL;
  }
  return Instantiate(instance, name, token, location, true);
}

EXPORTED void FMI2(FreeInstance)(void* component) { Free(component); }

EXPORTED int FMI2(SetDebugLogging)(void* component, int on, size_t count, const char* const categories[]) {
  Instance* instance = component;
  REQUIRE(ALIVE, "SetDebugLogging");
  return SetLogging(instance, on != 0, count, categories);
}

EXPORTED int FMI2(SetupExperiment)(void* component, int has_tolerance, double tolerance, double start_time,
                                   int has_stop_time, double stop_time) {
  Instance* instance = component;
  (void)has_tolerance, (void)tolerance, (void)has_stop_time, (void)stop_time;
  REQUIRE(INSTANTIATED, "SetupExperiment");
  if (!isfinite(start_time)) return Fail(instance, ERRED, "expected a finite start time");
  instance->at.start_time = instance->at.time = start_time;
  return OK;
}

EXPORTED int FMI2(EnterInitializationMode)(void* component) {
  Instance* instance = component;
  REQUIRE(INSTANTIATED, "EnterInitializationMode");
  return Initialize(instance, instance->at.start_time);
}

EXPORTED int FMI2(ExitInitializationMode)(void* component) {
  Instance* instance = component;
  REQUIRE(INITIALIZING, "ExitInitializationMode");
  return ExitInitialization(instance);
}

EXPORTED int FMI2(Terminate)(void* component) {
  Instance* instance = component;
  REQUIRE(STEPPING | STOPPED, "Terminate");
  return Terminate(instance);
}

EXPORTED int FMI2(Reset)(void* component) {
  Instance* instance = component;
  REQUIRE(ALIVE, "Reset");
  return Reset(instance);
}

EXPORTED int FMI2(GetReal)(void* component, const uint32_t references[], size_t count, double values[]) {
  Instance* instance = component;
  size_t k;
  int status = OK;
  REQUIRE(MAY_GET2, "GetReal");
  for (k = 0; k < count && status == OK; ++k) {
    const Variable* variable = Find(instance, "fmi2GetReal", references[k], TYPE_REAL);
    status = variable == NULL ? ERRED : BeforeGet(instance, variable);
    if (status == OK) values[k] = instance->values[references[k]].real;
  }
  return status;
}

EXPORTED int FMI2(GetInteger)(void* component, const uint32_t references[], size_t count, int values[]) {
  Instance* instance = component;
  size_t k;
  int status = OK;
  REQUIRE(MAY_GET2, "GetInteger");
  for (k = 0; k < count && status == OK; ++k) {
    const Variable* variable = Find(instance, "fmi2GetInteger", references[k], TYPE_INTEGER);
    status = variable == NULL ? ERRED : BeforeGet(instance, variable);
    if (status == OK && instance->values[references[k]].whole > INT_MAX)
      status = Fail(instance, ERRED, "fmi2GetInteger: %s is larger than an Integer of FMI 2 can be", variable->name);
    if (status == OK) values[k] = (int)instance->values[references[k]].whole;
  }
  return status;
}

EXPORTED int FMI2(GetBoolean)(void* component, const uint32_t references[], size_t count, int values[]) {
  Instance* instance = component;
  size_t k;
  int status = OK;
  REQUIRE(MAY_GET2, "GetBoolean");
  for (k = 0; k < count && status == OK; ++k) {
    const Variable* variable = Find(instance, "fmi2GetBoolean", references[k], TYPE_BOOLEAN);
    status = variable == NULL ? ERRED : BeforeGet(instance, variable);
    if (status == OK) values[k] = instance->values[references[k]].whole != 0;
  }
  return status;
}

EXPORTED int FMI2(GetString)(void* component, const uint32_t references[], size_t count, const char* values[]) {
  Instance* instance = component;
  size_t k;
  REQUIRE(MAY_GET2, "GetString");
  for (k = 0; k < count; ++k) {
    if (Find(instance, "fmi2GetString", references[k], TYPE_STRING) == NULL) return ERRED;
    values[k] = instance->values[references[k]].text;
  }
  return OK;
}

EXPORTED int FMI2(SetReal)(void* component, const uint32_t references[], size_t count, const double values[]) {
  Instance* instance = component;
  size_t k;
  int status = OK;
  REQUIRE(MAY_SET, "SetReal");
  for (k = 0; k < count && status == OK; ++k) status = SetReal(instance, "fmi2SetReal", references[k], values[k]);
  return status;
}

EXPORTED int FMI2(SetInteger)(void* component, const uint32_t references[], size_t count, const int values[]) {
  Instance* instance = component;
  size_t k;
  int status = OK;
  REQUIRE(MAY_SET, "SetInteger");
  for (k = 0; k < count && status == OK; ++k)
    status = SetWhole(instance, "fmi2SetInteger", references[k], TYPE_INTEGER, values[k]);
  return status;
}

EXPORTED int FMI2(SetBoolean)(void* component, const uint32_t references[], size_t count, const int values[]) {
  Instance* instance = component;
  size_t k;
  int status = OK;
  REQUIRE(MAY_SET, "SetBoolean");
  for (k = 0; k < count && status == OK; ++k)
    status = SetWhole(instance, "fmi2SetBoolean", references[k], TYPE_BOOLEAN, values[k] != 0);
  return status;
}

EXPORTED int FMI2(SetString)(void* component, const uint32_t references[], size_t count, const char* const values[]) {
  Instance* instance = component;
  size_t k;
  int status = OK;
  REQUIRE(MAY_SET, "SetString");
  for (k = 0; k < count && status == OK; ++k) status = SetText(instance, "fmi2SetString", references[k], values[k]);
  return status;
}

EXPORTED int FMI2(GetFMUstate)(void* component, void** state) {
  Instance* instance = component;
  REQUIRE(ALIVE, "GetFMUstate");
  return GetState(instance, state);
}

EXPORTED int FMI2(SetFMUstate)(void* component, void* state) {
  Instance* instance = component;
  REQUIRE(ALIVE, "SetFMUstate");
  return SetState(instance, state);
}

EXPORTED int FMI2(FreeFMUstate)(void* component, void** state) {
  Instance* instance = component;
  REQUIRE(ALIVE, "FreeFMUstate");
  return FreeKeptState(instance, state);
}

EXPORTED int FMI2(SerializedFMUstateSize)(void* component, void* state, size_t* size) {
  Instance* instance = component;
  REQUIRE(ALIVE, "SerializedFMUstateSize");
  return SerializedSize(instance, state, size);
}

EXPORTED int FMI2(SerializeFMUstate)(void* component, void* state, char bytes[], size_t size) {
  Instance* instance = component;
  REQUIRE(ALIVE, "SerializeFMUstate");
  return Serialize(instance, state, bytes, size);
}

EXPORTED int FMI2(DeSerializeFMUstate)(void* component, const char bytes[], size_t size, void** state) {
  Instance* instance = component;
  REQUIRE(ALIVE, "DeSerializeFMUstate");
  return Deserialize(instance, bytes, size, state);
}

EXPORTED int FMI2(DoStep)(void* component, double from, double step, int no_set_state) {
  Instance* instance = component;
  bool ends;
  int status;
  (void)no_set_state;
  REQUIRE(STEPPING, "DoStep");
  status = DoStep(instance, from, step, &ends);
  if (status != OK || !ends) return status;
  instance->at.mode = STOPPED;
  return Fail(instance, DISCARD, "the episode is over at %.17g s", instance->at.time);
}

EXPORTED int FMI2(CancelStep)(void* component) {
  Instance* instance = component;
  REQUIRE(0, "CancelStep"); /* no step goes on while the tool does something else */
  return OK;
}

enum { STATUS_MODES = STEPPING | STOPPED | FAILED | TERMINATED };

EXPORTED int FMI2(GetStatus)(void* component, int kind, int* value) {
  Instance* instance = component;
  REQUIRE(STATUS_MODES, "GetStatus");
  if (kind != 0) return NONE2(instance, "GetStatus");
  *value = instance->at.mode == STOPPED ? DISCARD : instance->at.mode == FAILED ? ERRED : OK;
  return OK;
}

EXPORTED int FMI2(GetRealStatus)(void* component, int kind, double* value) {
  Instance* instance = component;
  REQUIRE(STATUS_MODES, "GetRealStatus");
  if (kind != 2) return NONE2(instance, "GetRealStatus");
  *value = instance->at.time;
  return OK;
}

EXPORTED int FMI2(GetIntegerStatus)(void* component, int kind, int* value) {
  Instance* instance = component;
  (void)kind, (void)value;
  REQUIRE(STATUS_MODES, "GetIntegerStatus");
  return NONE2(instance, "GetIntegerStatus");
}

EXPORTED int FMI2(GetBooleanStatus)(void* component, int kind, int* value) {
  Instance* instance = component;
  REQUIRE(STATUS_MODES, "GetBooleanStatus");
  if (kind != 3) return NONE2(instance, "GetBooleanStatus");
  *value = instance->at.mode == STOPPED;
  return OK;
}

EXPORTED int FMI2(GetStringStatus)(void* component, int kind, const char** value) {
  Instance* instance = component;
  REQUIRE(STATUS_MODES, "GetStringStatus");
  if (kind != 1) return NONE2(instance, "GetStringStatus");
  *value = ""; /* no step is ever pending */
  return OK;
}

/* Functions of what this FMU does not have: model exchange, derivatives, interpolation. */
/* NOLINTBEGIN(bugprone-macro-parentheses): the parameters are a list with parentheses of its own */
#define LACKS2(name, parameters)       \
  EXPORTED int FMI2(name) parameters { \
    Instance* instance = component;    \
    REQUIRE(ALIVE, #name);             \
    return NONE2(instance, #name);     \
  }
/* NOLINTEND(bugprone-macro-parentheses) */
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
LACKS2(SetRealInputDerivatives,
       (void* component, const uint32_t references[], size_t count, const int orders[], const double values[]))
LACKS2(GetRealOutputDerivatives,
       (void* component, const uint32_t references[], size_t count, const int orders[], double values[]))
LACKS2(GetDirectionalDerivative,
       (void* component, const uint32_t unknowns[], size_t unknown_count, const uint32_t knowns[], size_t known_count,
        const double seed[], double sensitivity[]))
LACKS2(EnterEventMode, (void* component))
LACKS2(NewDiscreteStates, (void* component, EventInfo2* info))
LACKS2(EnterContinuousTimeMode, (void* component))
LACKS2(CompletedIntegratorStep, (void* component, int no_set_state, int* enter_event_mode, int* terminate))
LACKS2(SetTime, (void* component, double time))
LACKS2(SetContinuousStates, (void* component, const double states[], size_t count))
LACKS2(GetDerivatives, (void* component, double derivatives[], size_t count))
LACKS2(GetEventIndicators, (void* component, double indicators[], size_t count))
LACKS2(GetContinuousStates, (void* component, double states[], size_t count))
LACKS2(GetNominalsOfContinuousStates, (void* component, double nominals[], size_t count))
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

/* ------------------------------------------------------------------------------------------------------------------
 * FMI 3.0
 */

#define NONE3(instance, function) \
  Fail(instance, ERRED, "fmi3" function ": this FMU has none of what the function is for")

EXPORTED const char* FMI3(GetVersion)(void) { return "3.0"; }

EXPORTED int FMI3(SetDebugLogging)(void* component, bool on, size_t count, const char* const categories[]) {
  Instance* instance = component;
  REQUIRE(ALIVE, "SetDebugLogging");
  return SetLogging(instance, on, count, categories);
}

static void Ignore(void* environment, int status, const char* category, const char* message) {
  (void)environment, (void)status, (void)category, (void)message;
}

/* An instance of FMI 3, which has a logger, be it one that ignores all. */
static Instance* New3(bool logging_on, void* environment, Logger3 logger) {
  Instance* instance = calloc(1, sizeof *instance);
  if (instance == NULL) return NULL;
  instance->environment = environment;
  instance->logger3 = logger == NULL ? Ignore : logger;
  instance->log = logging_on ? 15 : 0;
  instance->socket = NO_SOCKET;
  instance->output = -1;
  return instance;
}

static void* Refuse3(Instance* instance, const char* words) {
  if (instance != NULL) Fail(instance, ERRED, "%s", words);
  Free(instance);
  return NULL;
}

EXPORTED void* FMI3(InstantiateCoSimulation)(const char* name, const char* token, const char* resources, bool visible,
                                             bool logging_on, bool event_mode_used, bool early_return_allowed,
                                             const uint32_t intermediate[], size_t intermediate_count,
                                             void* environment, Logger3 logger, void (*intermediate_update)(void)) {
  Instance* instance = New3(logging_on, environment, logger);
  (void)visible, (void)intermediate, (void)intermediate_update;
  if (instance == NULL) return NULL;
  instance->may_return_early = early_return_allowed;
  if (event_mode_used) return Refuse3(instance, "fmi3InstantiateCoSimulation: this FMU has no event mode");
  if (intermediate_count > 0)
    return Refuse3(instance, "fmi3InstantiateCoSimulation: this FMU has no intermediate variables");
  return Instantiate(instance, name, token, resources, false);
}

EXPORTED void* FMI3(InstantiateModelExchange)(const char* name, const char* token, const char* resources, bool visible,
                                              bool logging_on, void* environment, Logger3 logger) {
  (void)name, (void)token, (void)resources, (void)visible;
  return Refuse3(New3(logging_on, environment, logger),
                 "fmi3InstantiateModelExchange: this FMU is for co-simulation alone");
}

EXPORTED void* FMI3(InstantiateScheduledExecution)(const char* name, const char* token, const char* resources,
                                                   bool visible, bool logging_on, void* environment, Logger3 logger,
                                                   void (*clock_update)(void*), void (*lock)(void),
                                                   void (*unlock)(void)) {
  (void)name, (void)token, (void)resources, (void)visible, (void)clock_update, (void)lock, (void)unlock;
  return Refuse3(New3(logging_on, environment, logger),
                 "fmi3InstantiateScheduledExecution: this FMU is for co-simulation alone");
}

EXPORTED void FMI3(FreeInstance)(void* component) { Free(component); }

EXPORTED int FMI3(EnterInitializationMode)(void* component, bool has_tolerance, double tolerance, double start_time,
                                           bool has_stop_time, double stop_time) {
  Instance* instance = component;
  (void)has_tolerance, (void)tolerance, (void)has_stop_time, (void)stop_time;
  REQUIRE(INSTANTIATED, "EnterInitializationMode");
  return Initialize(instance, start_time);
}

EXPORTED int FMI3(ExitInitializationMode)(void* component) {
  Instance* instance = component;
  REQUIRE(INITIALIZING, "ExitInitializationMode");
  return ExitInitialization(instance);
}

EXPORTED int FMI3(Terminate)(void* component) {
  Instance* instance = component;
  REQUIRE(STEPPING | STOPPED, "Terminate");
  return Terminate(instance);
}

EXPORTED int FMI3(Reset)(void* component) {
  Instance* instance = component;
  REQUIRE(ALIVE, "Reset");
  return Reset(instance);
}

static int RequireScalars(Instance* instance, const char* function, size_t references, size_t values) {
  if (references == values) return OK;
  return Fail(instance, ERRED, "fmi3%s: all variables are scalars: expected %llu values, got %llu", function,
              (unsigned long long)references, (unsigned long long)values);
}

#define GETTER3(name, ctype, type, member)                                                            \
  EXPORTED int FMI3(name)(void* component, const uint32_t references[], size_t count, ctype values[], \
                          size_t value_count) {                                                       \
    Instance* instance = component;                                                                   \
    size_t k;                                                                                         \
    int status;                                                                                       \
    REQUIRE(MAY_GET3, #name);                                                                         \
    status = RequireScalars(instance, #name, count, value_count);                                     \
    for (k = 0; k < count && status == OK; ++k) {                                                     \
      const Variable* variable = Find(instance, "fmi3" #name, references[k], type);                   \
      status = variable == NULL ? ERRED : BeforeGet(instance, variable);                              \
      if (status == OK) values[k] = instance->values[references[k]].member;                           \
    }                                                                                                 \
    return status;                                                                                    \
  }
GETTER3(GetFloat64, double, TYPE_REAL, real)
GETTER3(GetInt64, int64_t, TYPE_INTEGER, whole)
GETTER3(GetBoolean, bool, TYPE_BOOLEAN, whole != 0)
GETTER3(GetString, const char*, TYPE_STRING, text)

#define SETTER3(name, ctype, set)                                                                           \
  EXPORTED int FMI3(name)(void* component, const uint32_t references[], size_t count, const ctype values[], \
                          size_t value_count) {                                                             \
    Instance* instance = component;                                                                         \
    const char* function = "fmi3" #name;                                                                    \
    size_t k;                                                                                               \
    int status;                                                                                             \
    REQUIRE(MAY_SET, #name);                                                                                \
    status = RequireScalars(instance, #name, count, value_count);                                           \
    for (k = 0; k < count && status == OK; ++k) status = set;                                               \
    return status;                                                                                          \
  }
SETTER3(SetFloat64, double, SetReal(instance, function, references[k], values[k]))
SETTER3(SetInt64, int64_t, SetWhole(instance, function, references[k], TYPE_INTEGER, values[k]))
SETTER3(SetBoolean, bool, SetWhole(instance, function, references[k], TYPE_BOOLEAN, values[k]))
EXPORTED int FMI3(SetString)(void* component, const uint32_t references[], size_t count, const char* const values[],
                             size_t value_count) {
  Instance* instance = component;
  size_t k;
  int status;
  REQUIRE(MAY_SET, "SetString");
  status = RequireScalars(instance, "SetString", count, value_count);
  for (k = 0; k < count && status == OK; ++k) status = SetText(instance, "fmi3SetString", references[k], values[k]);
  return status;
}

/* Types that no variable has. */
/* NOLINTBEGIN(bugprone-macro-parentheses): the parameters are a list with parentheses of its own */
#define NO_TYPE3(name, parameters)                                                                         \
  EXPORTED int FMI3(name) parameters {                                                                     \
    Instance* instance = component;                                                                        \
    REQUIRE(MAY_GET3, #name);                                                                              \
    (void)references, (void)values;                                                                        \
    return count == 0 ? OK : Fail(instance, ERRED, "fmi3" #name ": no variable of this FMU has the type"); \
  }
/* NOLINTEND(bugprone-macro-parentheses) */
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
#define NO_NUMBERS3(name, ctype)                                                                              \
  NO_TYPE3(Get##name, (void* component, const uint32_t references[], size_t count, ctype values[], size_t n)) \
  NO_TYPE3(Set##name, (void* component, const uint32_t references[], size_t count, const ctype values[], size_t n))
NO_NUMBERS3(Float32, float)
NO_NUMBERS3(Int8, int8_t)
NO_NUMBERS3(UInt8, uint8_t)
NO_NUMBERS3(Int16, int16_t)
NO_NUMBERS3(UInt16, uint16_t)
NO_NUMBERS3(Int32, int32_t)
NO_NUMBERS3(UInt32, uint32_t)
NO_NUMBERS3(UInt64, uint64_t)
NO_TYPE3(GetBinary, (void* component, const uint32_t references[], size_t count, size_t sizes[],
                     const unsigned char* values[], size_t n))
NO_TYPE3(SetBinary, (void* component, const uint32_t references[], size_t count, const size_t sizes[],
                     const unsigned char* const values[], size_t n))
NO_TYPE3(GetClock, (void* component, const uint32_t references[], size_t count, bool values[]))
NO_TYPE3(SetClock, (void* component, const uint32_t references[], size_t count, const bool values[]))

/* Functions of what this FMU does not have. */
/* NOLINTBEGIN(bugprone-macro-parentheses): the parameters are a list with parentheses of its own */
#define LACKS3(name, parameters)       \
  EXPORTED int FMI3(name) parameters { \
    Instance* instance = component;    \
    REQUIRE(ALIVE, #name);             \
    return NONE3(instance, #name);     \
  }
/* NOLINTEND(bugprone-macro-parentheses) */
LACKS3(GetNumberOfVariableDependencies, (void* component, uint32_t reference, size_t* count))
LACKS3(GetVariableDependencies, (void* component, uint32_t dependent, size_t dependent_elements[],
                                 uint32_t independents[], size_t independent_elements[], int kinds[], size_t count))
LACKS3(GetDirectionalDerivative,
       (void* component, const uint32_t unknowns[], size_t unknown_count, const uint32_t knowns[], size_t known_count,
        const double seed[], size_t seed_count, double sensitivity[], size_t sensitivity_count))
LACKS3(GetAdjointDerivative,
       (void* component, const uint32_t unknowns[], size_t unknown_count, const uint32_t knowns[], size_t known_count,
        const double seed[], size_t seed_count, double sensitivity[], size_t sensitivity_count))
LACKS3(EnterEventMode, (void* component))
LACKS3(EnterStepMode, (void* component))
LACKS3(EnterConfigurationMode, (void* component))
LACKS3(ExitConfigurationMode, (void* component))
LACKS3(GetIntervalDecimal,
       (void* component, const uint32_t references[], size_t count, double intervals[], int qualifiers[]))
LACKS3(GetIntervalFraction, (void* component, const uint32_t references[], size_t count, uint64_t counters[],
                             uint64_t resolutions[], int qualifiers[]))
LACKS3(GetShiftDecimal, (void* component, const uint32_t references[], size_t count, double shifts[]))
LACKS3(GetShiftFraction,
       (void* component, const uint32_t references[], size_t count, uint64_t counters[], uint64_t resolutions[]))
LACKS3(SetIntervalDecimal, (void* component, const uint32_t references[], size_t count, const double intervals[]))
LACKS3(SetIntervalFraction, (void* component, const uint32_t references[], size_t count, const uint64_t counters[],
                             const uint64_t resolutions[]))
LACKS3(SetShiftDecimal, (void* component, const uint32_t references[], size_t count, const double shifts[]))
LACKS3(SetShiftFraction, (void* component, const uint32_t references[], size_t count, const uint64_t counters[],
                          const uint64_t resolutions[]))
LACKS3(EvaluateDiscreteStates, (void* component))
LACKS3(UpdateDiscreteStates, (void* component, bool* needs_update, bool* terminate, bool* nominals_changed,
                              bool* values_changed, bool* next_event_time_defined, double* next_event_time))
LACKS3(EnterContinuousTimeMode, (void* component))
LACKS3(CompletedIntegratorStep, (void* component, bool no_set_state, bool* enter_event_mode, bool* terminate))
LACKS3(SetTime, (void* component, double time))
LACKS3(SetContinuousStates, (void* component, const double states[], size_t count))
LACKS3(GetContinuousStateDerivatives, (void* component, double derivatives[], size_t count))
LACKS3(GetEventIndicators, (void* component, double indicators[], size_t count))
LACKS3(GetContinuousStates, (void* component, double states[], size_t count))
LACKS3(GetNominalsOfContinuousStates, (void* component, double nominals[], size_t count))
LACKS3(GetNumberOfEventIndicators, (void* component, size_t* count))
LACKS3(GetNumberOfContinuousStates, (void* component, size_t* count))
LACKS3(GetOutputDerivatives,
       (void* component, const uint32_t references[], size_t count, const int32_t orders[], double values[], size_t n))
LACKS3(ActivateModelPartition, (void* component, uint32_t clock, double time))
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

EXPORTED int FMI3(GetFMUState)(void* component, void** state) {
  Instance* instance = component;
  REQUIRE(ALIVE, "GetFMUState");
  return GetState(instance, state);
}

EXPORTED int FMI3(SetFMUState)(void* component, void* state) {
  Instance* instance = component;
  REQUIRE(ALIVE, "SetFMUState");
  return SetState(instance, state);
}

EXPORTED int FMI3(FreeFMUState)(void* component, void** state) {
  Instance* instance = component;
  REQUIRE(ALIVE, "FreeFMUState");
  return FreeKeptState(instance, state);
}

EXPORTED int FMI3(SerializedFMUStateSize)(void* component, void* state, size_t* size) {
  Instance* instance = component;
  REQUIRE(ALIVE, "SerializedFMUStateSize");
  return SerializedSize(instance, state, size);
}

EXPORTED int FMI3(SerializeFMUState)(void* component, void* state, uint8_t bytes[], size_t size) {
  Instance* instance = component;
  REQUIRE(ALIVE, "SerializeFMUState");
  return Serialize(instance, state, bytes, size);
}

EXPORTED int FMI3(DeserializeFMUState)(void* component, const uint8_t bytes[], size_t size, void** state) {
  Instance* instance = component;
  REQUIRE(ALIVE, "DeserializeFMUState");
  return Deserialize(instance, bytes, size, state);
}

EXPORTED int FMI3(DoStep)(void* component, double from, double step, bool no_set_state, bool* event_needed,
                          bool* terminate, bool* early_return, double* last_time) {
  Instance* instance = component;
  bool ends = false;
  int status;
  (void)no_set_state;
  REQUIRE(STEPPING, "DoStep");
  if (event_needed != NULL) *event_needed = false;
  if (early_return != NULL) *early_return = false;
  if (terminate != NULL) *terminate = false;
  status = DoStep(instance, from, step, &ends);
  if (status == OK && ends) instance->at.mode = STOPPED;
  if (ends && !instance->may_return_early) instance->at.time = from + step; /* the outputs are held until then */
  if (terminate != NULL) *terminate = ends;
  if (early_return != NULL) *early_return = ends && instance->may_return_early;
  if (last_time != NULL) *last_time = instance->at.time;
  return status;
}
