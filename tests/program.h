#pragma once
/// Runs the real clrender as a user does, in a folder of its own.

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

namespace clrender::test {

namespace fs = std::filesystem;

/// A new empty folder, removed with all that is in it.
class TempFolder {
public:
    TempFolder() {
        std::string pattern = (fs::temp_directory_path() / "clrender_test_XXXXXX").string();
        if (mkdtemp(pattern.data()) == nullptr)
            throw std::runtime_error("cannot make a temporary folder");
        path_ = pattern;
    }
    ~TempFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    TempFolder(const TempFolder &) = delete;
    TempFolder &operator=(const TempFolder &) = delete;

    [[nodiscard]] const fs::path &path() const { return path_; }
    [[nodiscard]] bool has(const std::string &name) const { return fs::exists(path_ / name); }

    /// Writes a file and returns its name inside the folder.
    std::string write(const std::string &name, const std::string &content) const {
        std::ofstream(path_ / name, std::ios::binary) << content;
        return name;
    }

private:
    fs::path path_;
};

inline std::string read_file(const fs::path &path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

/// What a run left behind. `exit_code` is 128 + N after signal N, as a shell says it.
struct ProgramResult {
    int exit_code = 0;
    std::string out;
    std::string err;
    double seconds = 0;     ///< by the clock
    double cpu_seconds = 0; ///< of all its threads; does not depend on what else the machine does
    long peak_kib = 0;      ///< the most memory it had
};

/// A run of clrender that may be sent a signal before it ends.
class Program {
public:
    /// Starts it in `folder`, which also receives what it prints; `environment` is added to ours.
    /// `prepare` runs in the new process, for limits and descriptors.
    Program(const fs::path &folder, std::vector<std::string> arguments,
            const std::vector<std::pair<std::string, std::string>> &environment = {},
            const std::function<void()> &prepare = {})
        : folder_(folder), start_(std::chrono::steady_clock::now()) {
        arguments.insert(arguments.begin(), CLRENDER_BINARY);
        std::vector<char *> argv;
        for (std::string &argument : arguments)
            argv.push_back(argument.data());
        argv.push_back(nullptr);

        process_ = fork();
        if (process_ < 0)
            throw std::runtime_error("cannot start a process");
        if (process_ == 0) {
            redirect("/dev/null", O_RDONLY, STDIN_FILENO);
            redirect(out_file(), O_WRONLY | O_CREAT | O_TRUNC, STDOUT_FILENO);
            redirect(err_file(), O_WRONLY | O_CREAT | O_TRUNC, STDERR_FILENO);
            for (const auto &[name, value] : environment)
                setenv(name.c_str(), value.c_str(), 1);
            if (prepare)
                prepare();
            if (chdir(folder_.c_str()) == 0)
                execv(argv[0], argv.data());
            _exit(127);
        }
    }

    void send(int signal) const { kill(process_, signal); }

    /// Waits until it has printed `text` on stderr, for two minutes at most.
    void wait_for(const std::string &text) const {
        for (int i = 0; i < 12000; ++i) {
            if (read_file(err_file()).find(text) != std::string::npos)
                return;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        throw std::runtime_error("clrender has not printed '" + text + "'");
    }

    /// Waits for its end.
    ProgramResult wait() {
        int status = 0;
        rusage usage = {};
        wait4(process_, &status, 0, &usage);
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start_;
        ProgramResult result;
        result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        result.out = read_file(out_file());
        result.err = read_file(err_file());
        result.seconds = seconds.count();
        result.cpu_seconds = to_seconds(usage.ru_utime) + to_seconds(usage.ru_stime);
        result.peak_kib = usage.ru_maxrss;
        fs::remove(out_file());
        fs::remove(err_file());
        return result;
    }

private:
    [[nodiscard]] fs::path out_file() const { return folder_ / ".stdout"; }
    [[nodiscard]] fs::path err_file() const { return folder_ / ".stderr"; }

    static double to_seconds(const timeval &time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    }

    static void redirect(const fs::path &file, int flags, int descriptor) {
        dup2(open(file.c_str(), flags, 0644), descriptor);
    }

    fs::path folder_;
    pid_t process_ = 0;
    std::chrono::steady_clock::time_point start_;
};

/// Runs clrender in `folder` to its end.
inline ProgramResult
run_clrender(const fs::path &folder, const std::vector<std::string> &arguments,
             const std::vector<std::pair<std::string, std::string>> &environment = {},
             const std::function<void()> &prepare = {}) {
    return Program(folder, arguments, environment, prepare).wait();
}

/// True if `text` is one line with its newline, and no more.
inline bool is_one_line(const std::string &text) {
    return !text.empty() && text.find('\n') == text.size() - 1;
}

} // namespace clrender::test
