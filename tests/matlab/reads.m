function reads(folder, answers)
% Writes what mascot.read_run reads in FOLDER: arrays as lists in MATLAB's order, figures and events.
run = mascot.read_run(folder);
file = fopen(answers, 'w');
for name = {'t', 'id', 'position', 'velocity', 'angular_velocity', 'acceleration_command', 'orientation', ...
            'actuator', 'flags'}
  array = run.(name{1});
  fprintf(file, '%s\n', mascot.json_text({name{1}, num2cell(size(array)), reshape(double(array), 1, [])}));
end
fprintf(file, '%s\n', mascot.json_text({'figures', {run.figures.name}, {run.figures.value}}));
for k = 1:numel(run.events)
  event = run.events(k);
  if isnan(event.agent), event.agent = ''; end
  fprintf(file, '%s\n', mascot.json_text({'event', event}));
end
fprintf(file, '%s\n', mascot.json_text({'config', run.config}));
fclose(file);
end
