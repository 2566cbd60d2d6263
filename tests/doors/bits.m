% The lines of tests/portability/digest.cpp, which has what is computed, from Octave.
1;
function text = hashed(numbers)
  first = second = 1;
  for byte = double(typecast(numbers, 'uint8'))
    first = mod(257 * first + byte, 4294967291);  % exact: below 2^53
    second = mod(65599 * second + byte, 4294967291);
  end
  text = sprintf('%08x%08x', first, second);
end

arguments = argv();
verb = folder = '';
if numel(arguments) == 2
  [verb, folder] = arguments{:};
end
d = 5; rows = 1000; half = 500;
s = 1;
records = zeros(d + 1, rows);
for n = 1:numel(records)
  s = mod(1664525 * s + 1013904223, 2^32);
  records(n) = floor(s / 2^8) / 2^23 - 1;
end
for arithmetic = rlslab('names', 1)
  for variant = rlslab('names', 0)
    filter = rlslab('new', variant{1}, arithmetic{1}, d, struct('forgetting', 0.9921875));
    path = [folder '/' variant{1} '.' arithmetic{1}];
    from = 0;
    if strcmp(verb, 'load')
      file = fopen(path, 'r');
      rlslab('load', filter, fread(file, Inf, '*uint8')');
      fclose(file);
      from = half;
    end
    for k = from:rows - 1
      if k == half && strcmp(verb, 'save')
        file = fopen(path, 'w');
        fwrite(file, rlslab('save', filter), 'uint8');
        fclose(file);
      end
      rlslab('update', filter, records(1:d, k + 1), records(d + 1, k + 1));
    end
    try
      matrix = rlslab('covariance', filter);
    catch
      matrix = rlslab('information', filter);
    end
    printf('%s %s %s\n', variant{1}, arithmetic{1}, ...
           hashed([rlslab('theta', filter)' rlslab('gain', filter)' matrix(:)']));
    rlslab('free', filter);
  end
end
