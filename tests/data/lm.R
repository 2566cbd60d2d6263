# Writes lm.json, R's answers to what tests/identify/lm.cpp asks: coefficients and standard errors of lm on the program's
# examples, and the sums of the recursive residuals of these models and of their squares, at the quarters of the rows,
# with the first row at which |sum| is outside 0.948 sqrt(m) (1 + 2 r/m), 0 if none; of five of their columns the least eigenvalue of the mean of v v', v = (x[k], ..., x[k-n+1]), and the
# condition number of the rows v'; outputs of five systems of which `rlslab simulate` wrote u and y.
# In the folder of `rlslab example NAME > NAME.csv` and `rlslab simulate WORDS > system_N.csv`, the words of that test:
# R --vanilla --slave -f lm.R > lm.json
lag <- function(x, l) c(rep(NA, l), x[seq_len(length(x) - l)])
arx <- function(y, u) lm(y ~ I(-lag(y, 1)) + I(-lag(y, 2)) + u + lag(u, 1) + lag(u, 2))
sales <- read.csv("sales.csv"); consumption <- read.csv("consumption.csv"); s <- read.csv("sunspots.csv")$number
models <- list(
  sales = arx(sales$sales, sales$lead),
  consumption = arx(consumption$consumption, consumption$income),
  sunspots = lm(s ~ I(-lag(s, 1)) + I(-lag(s, 2)) + I(-lag(s, 3)) + I(-lag(s, 9))),
  airquality = lm(Ozone ~ Solar.R + Wind + Temp, read.csv("airquality.csv")),
  longley = lm(y ~ x1 + x2 + x3 + x4 + x5 + x6, read.csv("longley.csv")))
list_of <- function(x) paste(sprintf("%.17g", x), collapse = ", ")
constancy <- function(model) {
  X <- model.matrix(model); y <- model.response(model.frame(model)); d <- ncol(X); m <- nrow(X) - d
  w <- vapply(d + seq_len(m), function(k) {
    before <- lm.fit(X[seq_len(k - 1), ], y[seq_len(k - 1)], tol = 1e-14)
    r <- backsolve(qr.R(before$qr), X[k, before$qr$pivot], transpose = TRUE)
    (y[k] - sum(X[k, ] * before$coefficients)) / sqrt(1 + sum(r^2))
  }, 0)
  W <- cumsum(w) / sqrt(sum(w^2) / m); s <- cumsum(w^2) / sum(w^2); r <- seq_len(m); at <- ceiling(m * (1:4) / 4)
  outside <- which(abs(W) > 0.948 * sqrt(m) * (1 + 2 * r / m))
  sprintf('"cusum": [%s], "squares": [%s], "crosses": %d, "off": %.17g', list_of(W[at]), list_of(s[at]),
          if (length(outside)) outside[1] else 0L, max(abs(s - r / m)))
}
one <- function(name) {
  table <- summary(models[[name]])$coefficients
  sprintf('"%s": {"value": [%s], "sd": [%s], %s}', name, list_of(table[, 1]), list_of(table[, 2]),
          constancy(models[[name]]))
}
excitation <- function(x) {
  rows <- lapply(1:5, embed, x = x)
  least <- vapply(rows, function(v) tail(svd(v)$d, 1)^2 / nrow(v), 0)
  condition <- vapply(rows, function(v) { d <- svd(v)$d; d[1] / tail(d, 1) }, 0)
  sprintf('{"least": [%s], "condition": [%s]}', list_of(least), list_of(condition))
}
columns <- list(lead = sales$lead, income = consumption$income, number = s, Wind = read.csv("airquality.csv")$Wind,
                x2 = read.csv("longley.csv")$x2)
simulated <- function(number, a, b, delay) {
  u <- read.csv(sprintf("system_%d.csv", number), comment.char = "#")$u
  forced <- filter(c(rep(0, delay + length(b)), u), c(rep(0, delay), b), sides = 1)[-seq_len(delay + length(b))]
  y <- if (length(a)) filter(forced, -a, "recursive") else forced
  sprintf('{"y": [%s]}', list_of(y[c(1, 2, 3, 10, 100, 500)]))
}
systems <- list(simulated(1, c(-1.5, 0.7), c(1, 0.5), 0), simulated(2, c(-0.9), c(0, 2), 3),
                simulated(3, c(), c(1, -1, 0.25), 1), simulated(4, c(-2.1, 1.61, -0.441), c(0.3), 0),
                simulated(5, c(0.2, 0.9), c(1), 2))
quoted <- function(names, texts) sprintf('"%s": %s', names, texts)
cat("{\n", paste(c(vapply(names(models), one, ""),
                  quoted(names(columns), vapply(columns, excitation, "")),
                  quoted(sprintf("system_%d", 1:5), unlist(systems))), collapse = ",\n"), "\n}\n", sep = "")
