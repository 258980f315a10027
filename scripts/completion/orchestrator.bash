# Completion of MASCOT's orchestrator for bash. Verbs, options and their values are those that the program that is typed
# tells of itself, `orchestrator --help` and `orchestrator VERB --help`: nothing is listed here.

# _orchestrator_rows SECTION HELP: the lines of a section, without those that only go on with a description
_orchestrator_rows() {
  local line inside=
  while IFS= read -r line; do
    case $line in
      "$1:") inside=yes ;;
      '  '[!\ ]*) [ -z "$inside" ] || printf '%s\n' "${line#  }" ;;
      [!\ ]*) inside= ;;
    esac
  done <<<"$2"
}

# _orchestrator_value ROW: what an option takes, such as DIR or TEXT:{dds,inprocess}; nothing if it takes nothing
_orchestrator_value() {
  [[ $1 =~ ^[^\ ]+\ ([^\ ]+) ]] || return
  case ${BASH_REMATCH[1]} in
    Needs: | Excludes: | REQUIRED) ;;
    *) printf '%s\n' "${BASH_REMATCH[1]}" ;;
  esac
}

# _orchestrator_offer WORD KIND [ROW]: what a word of this kind may be, into COMPREPLY
_orchestrator_offer() {
  local name alternatives
  case $2 in
    *:\{*\}*)
      alternatives=${2#*\{}
      mapfile -t COMPREPLY < <(compgen -W "$(tr , ' ' <<<"${alternatives%%\}*}")" -- "$1")
      ;;
    CONFIG) _orchestrator_files "$1" toml ;;
    RUN | DIR | FOLDER | FILE | FILE_OR_DIR)
      case $2 in
        RUN) _orchestrator_files "$1" mcap ;;
        FILE*) _orchestrator_files "$1" '' ;;
        *) _orchestrator_files "$1" / ;;
      esac
      ;;
    NAME | LAW)  # of a law, or of what the verb lists
      name='^    "name": "([^"]+)"'
      [ "$2" = NAME ] || verb=laws
      while IFS= read -r line; do
        [[ ! $line =~ $name ]] || COMPREPLY+=("${BASH_REMATCH[1]}")
      done < <("$program" "$verb" --json 2>/dev/null </dev/null)
      mapfile -t COMPREPLY < <(compgen -W "${COMPREPLY[*]}" -- "$1")
      ;;
    KEY=VALUE | PREFIX)
      [ "$2" = PREFIX ] || compopt -o nospace 2>/dev/null
      mapfile -t COMPREPLY < <("$program" keys --names "$1" 2>/dev/null </dev/null)
      [ "$2" = PREFIX ] || COMPREPLY=("${COMPREPLY[@]/%/=}")
      ;;
    VERB) mapfile -t COMPREPLY < <(compgen -W "$(_orchestrator_names Subcommands "$main")" -- "$1") ;;
    WHAT)  # "pause | step [TICKS] | ...": the first word of each
      alternatives=" | ${3#*...} |"
      while [[ $alternatives =~ \|\ +([a-z]+) ]]; do
        COMPREPLY+=("${BASH_REMATCH[1]}")
        alternatives=${alternatives#*"${BASH_REMATCH[0]}"}
      done
      for name in "${COMPREPLY[@]}"; do
        [[ " ${words[*]} " != *" $name "* ]] || { COMPREPLY=() && return; }  # it has been said
      done
      mapfile -t COMPREPLY < <(compgen -W "${COMPREPLY[*]}" -- "$1")
      ;;
  esac
}

# _orchestrator_files WORD ENDING: folders, and files with this ending; none has the ending "/", all have an empty one
_orchestrator_files() {
  local path
  compopt -o filenames 2>/dev/null
  while IFS= read -r path; do
    [[ ! -d $path && $2 && $path != *".$2" ]] || COMPREPLY+=("$path")
  done < <(compgen -f -- "$1")
}

# _orchestrator_names SECTION HELP: the names of its rows: both of "-h,--help"
_orchestrator_names() {
  local row
  while IFS= read -r row; do
    [ -z "$row" ] || tr , '\n' <<<"${row%% *}"
  done < <(_orchestrator_rows "$1" "$2")
}

_orchestrator() {
  local program=${1/#\~/$HOME} word=$2 before=$3 main help verb= row kind
  local words=("${COMP_WORDS[@]:1:COMP_CWORD-1}")
  COMPREPLY=()
  if [ "$word" = = ]; then  # --engine=, which bash takes for two words
    word= before=${COMP_WORDS[COMP_CWORD - 1]}
  elif [ "$before" = = ]; then
    before=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  main=$("$program" --help 2>/dev/null </dev/null)
  [[ -z ${words[0]-} || ${words[0]} = -* ]] || verb=${words[0]}
  if [[ -z $verb || $verb = help ]]; then
    kind=Subcommands
    [[ $word != -* ]] || kind=Options
    mapfile -t COMPREPLY < <(compgen -W "$(_orchestrator_names $kind "$main")" -- "$word")
    return
  fi
  help=$("$program" "$verb" --help 2>/dev/null </dev/null)
  while IFS= read -r row; do  # the value of the option in front?
    if [[ ",${row%% *}," = *",$before,"* ]]; then
      kind=$(_orchestrator_value "$row")
      # A value in brackets may be left out.
      [[ -z $kind || $kind = \[* && $word != [!-]* ]] || { _orchestrator_offer "$word" "$kind" && return; }
    fi
  done < <(_orchestrator_rows Options "$help")
  if [[ $word = -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_orchestrator_names Options "$help")" -- "$word")
    return
  fi
  row=$(_orchestrator_rows Positionals "$help" | head -n 1)
  _orchestrator_offer "$word" "$(_orchestrator_value "$row")" "$row"
}

complete -F _orchestrator orchestrator
