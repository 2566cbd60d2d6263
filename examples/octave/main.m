% y = 0.8 u(k) - 0.3 u(k-1) and a little noise; one row is wrong. A guard finds it, and the filter goes on.
1;
function [x, s] = draw(s)
  s = mod(1664525 * s + 1013904223, 2^32);  % exact: below 2^53
  x = s / 2^31 - 1;
end

s = 1;
u = 0;
filter = rlslab('new', 'ud', 'double', 2, struct('forgetting', 0.99, 'guard', 'reset'));
signals = rlslab('names', 5);
healths = rlslab('names', 4);
for row = 0:299
  before = u;
  [u, s] = draw(s);
  [noise, s] = draw(s);
  y = 0.8 * u - 0.3 * before + 0.01 * noise;
  if row == 200
    y += 5;
  end
  [~, ~, ~, health, signal] = rlslab('update', filter, [u before], y);
  if signal
    printf('row %d: %s\n', row, signals{signal + 1});
  end
end
printf('theta %.2f %.2f\n', rlslab('theta', filter));
printf('%d outlier, %s\n', rlslab('counts', filter).outliers, healths{health + 1});
try
  rlslab('new', 'udd', 'double', 2);
catch error
  disp(error.message(9:24));  % after "rlslab: ", which Octave adds
end
rlslab('free', filter);
