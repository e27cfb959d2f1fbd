module kiwami.org/kiwami

go 1.19
