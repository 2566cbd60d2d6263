# Writes lm.json: coefficients and standard errors of R's lm on the program's examples, the models of
# tests/identify/lm.cpp. In the folder of `rlslab example NAME > NAME.csv`: R --vanilla --slave -f lm.R > lm.json
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
one <- function(name) {
  table <- summary(models[[name]])$coefficients
  sprintf('"%s": {"value": [%s], "sd": [%s]}', name, list_of(table[, 1]), list_of(table[, 2]))
}
cat("{\n", paste(vapply(names(models), one, ""), collapse = ",\n"), "\n}\n", sep = "")
