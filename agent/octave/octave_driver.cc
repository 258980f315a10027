#include "agent/octave/octave_driver.h"

namespace mascot {

// Most of the time of a call goes to the steps of this loop, some microseconds each: mat2cell and cell2struct, once for
// all neighbours, are the fastest way to make structs, and what is rarely needed is in functions of its own.
const std::string_view kOctaveDriverText = R"octave(function mascot_driver(input, output, seed, max_message)
  crash_dumps_octave_core(false); sighup_dumps_octave_core(false); sigterm_dumps_octave_core(false);
  warning("off", "backtrace");
  folder = pwd();
  from = fopen(input, "r");
  to = fopen(output, "w");
  of_me = {"id"; "position"; "velocity"; "acceleration"; "orientation"; "angular_velocity"; "ranges"; "message"};
  of_neighbour = [of_me(1:6); {"weight"; "age_s"; "message"}];
  params = struct();
  while true
    count = fread(from, 1, "double");
    if isempty(count)
      exit(0);  % the program at the other end has ended
    end
    frame = fread(from, count, "double");
    try
      switch frame(1)
        case 2
          data = 3 + frame(2);
          values = mat2cell(frame(data:end), frame(3:data - 1), 1);
          values{8} = reshape(values{8}, 3, []);
          me = cell2struct(values(2:9), of_me, 1);
          neighbours = cell2struct(reshape(values(10:end), 9, 1, []), of_neighbour, 1);
          message = [];
          if sends
            [a, message] = control(values{1}, me, neighbours, extra{:});
          else
            a = control(values{1}, me, neighbours, extra{:});
          end
          if !(isa(a, "double") && isreal(a) && (numel(a) == 3 || numel(a) == 2) && isfinite(sum(a(:))))
            require(a, "control", 2, 3, "3 numbers or 2 (x, y)");
            a = double(a);
          end
          if !isempty(message)
            require(message, "the second output of control", 0, max_message, ...
                    sprintf("at most %d numbers", max_message));
            message = double(message);
          end
          fflush(stdout);
          fwrite(to, [2 + numel(a) + numel(message); 0; numel(a); a(:); message(:)], "double");
          fflush(to);
        case 1
          params = eval(char(frame(2:end)'));
          if takes_params
            extra = {params};
          end
        case 0
          rand("twister", seed); randn("twister", seed); rande("twister", seed);
          randg("twister", seed); randp("twister", seed);
          [inputs, outputs] = read_files();
          takes_params = inputs < 0 || inputs > 3;
          sends = abs(outputs) > 1;
          extra = cell(1, takes_params);
          tell(to, [0; inputs; outputs]);
      end
    catch mistake
      tell_mistake(to, mistake, folder);
    end
  end
end

% The numbers of inputs and outputs of control. Reads all files, so that mistakes in them are found.
function [inputs, outputs] = read_files()
  lastwarn("");
  try
    inputs = nargin("control");
    outputs = nargout("control");
  catch mistake
    if strncmp(mistake.message, "parse error", 11)
      rethrow(mistake);
    end
    error("expected a file that begins with the function control, got none");
  end
  if any(strfind(lastwarn(), "does not agree with function file"))
    error("expected a file that begins with the function control, got another function");
  end
  files = glob("*.m");
  for k = 1:numel(files)
    try
      nargin(files{k}(1:end - 2));
    catch mistake
      if strncmp(mistake.message, "parse error", 11)
        rethrow(mistake);
      end
    end
  end
  lastwarn("");
end

function require(value, who, least, most, expected)
  n = numel(value);
  if !(isnumeric(value) || islogical(value))
    error("%s is a %s, expected %s", who, class(value), expected);
  elseif !isreal(value)
    error("%s is complex, expected %s", who, expected);
  elseif n < least || n > most || n != max(size(value))
    error("%s is %s, expected %s", who, sprintf(" x %d", size(value))(4:end), expected);
  elseif !all(isfinite(value(:)))
    error("%s is %s, expected finite numbers", who, mat2str(value));
  end
end

function tell(to, numbers)
  fwrite(to, [numel(numbers); numbers], "double");
  fflush(to);
end

% The place is where the user's own code was.
function tell_mistake(to, mistake, folder)
  file = ""; line = 0; column = 0;
  for k = 1:numel(mistake.stack)
    s = mistake.stack(k);
    if strncmp(s.file, folder, numel(folder)) && isempty(strfind(s.file, "mascot_driver"))
      file = s.file; line = s.line; column = s.column;
      break;
    end
  end
  text = sprintf("%s\n%d\n%d\n%s", file, line, column, mistake.message);
  fflush(stdout);
  tell(to, [1; double(text(:))]);
end
)octave";

}  // namespace mascot
